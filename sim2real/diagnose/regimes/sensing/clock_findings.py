"""Decide whether the camera's clock has a delay or a drift: select the simplest of four clocks that is not rejected."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.regimes.sensing.clock import EXACT, Clock, ClockFit, TimedContacts, fit_clock, search_clock
from sim2real.diagnose.regimes.sensing.held_out import held_out_errors
from sim2real.diagnose.regimes.sensing.tuned import CLOCK, SIGNIFICANCE_LEVEL
from sim2real.diagnose.result.result import Alternative, Estimate, Finding, Proof
from sim2real.statistics.intervals import reach

MODELS = {"none": (False, False), "camera_delay": (True, False), "clock_drift": (False, True), "both": (True, True)}
DRIFT = EFFECTS["clock_drift"]
FORMULAS = {"camera_delay": "a frame stamped t shows the encoders' time t - delay_s", "clock_drift": DRIFT.law}


@dataclass(frozen=True)
class ClockResult:
    """The fitted clock (None if no error was found), its findings, and its cross-validated errors, `selection`.

    `determined`: whether the contacts suffice to find a delay of ten times `CLOCK.least_delay`.
    """

    fit: ClockFit | None
    findings: tuple[Finding, ...]
    selection: Proof | None
    determined: bool

    @property
    def clock(self) -> Clock:
        """The clock; EXACT if no error was found."""
        return EXACT if self.fit is None else self.fit.clock


def identify_clock(tables: list[TimedContacts]) -> ClockResult:
    """Identify the camera's clock from the contacts with the robot's mallet, `tables` of all recordings."""
    nothing = ClockResult(None, (), None, False)
    tables = [one for one in tables if len(one.t) >= 2]
    if not tables:
        return nothing
    start = search_clock(tables)
    fits = {name: fit_clock(tables, start, free) for name, free in MODELS.items()}
    if fits["both"] is None:
        fits["both"] = fits["camera_delay"]
    full = fits["both"]
    if full is None or full.freedom < 3:
        return nothing
    chance = {name: _chance(each, full, 2 - sum(MODELS[name])) for name, each in fits.items()}
    span = max(float(np.ptp(each.t)) for each in tables)
    name = _choose(chance, full, span)
    determined = float(np.sqrt(full.clock.covariance[0, 0])) < 10 * CLOCK.least_delay
    if name == "none":
        return ClockResult(None, (), None, determined)
    best = fits[name]
    assert best is not None
    before = np.concatenate([each.gaps(np.array(0.0), np.array(0.0))[0] for each in tables])
    before = np.where(full.touches, before, np.nan)
    left_out = held_out_errors(before, _left_out(tables, start, MODELS[name], full), full.std, full.launch)
    if left_out is None or left_out.proof.after_m > CLOCK.better * left_out.proof.before_m:
        return ClockResult(None, (), None, determined)
    named = ("camera_delay", "clock_drift") if name == "both" else (name,)
    findings = tuple(_finding(each, named, best, fits, chance, full) for each in named)
    return ClockResult(best, findings, left_out.proof, True)


def _choose(chance: dict[str, float], full: ClockFit, span: float) -> str:
    """Select the simplest clock that is not rejected against the full one; "none" if the exact clock is accepted."""
    matters = abs(full.clock.delay) > CLOCK.least_delay or abs(full.clock.rate) * span > CLOCK.least_delay
    if chance["none"] > SIGNIFICANCE_LEVEL or not matters:
        return "none"
    single = max(("camera_delay", "clock_drift"), key=lambda name: chance[name])
    return single if chance[single] > CLOCK.rejected else "both"


def _chance(reduced: ClockFit | None, full: ClockFit, fewer: int) -> float:
    """p-value of the clock `reduced`, which has `fewer` parameters than the full one, by an F test."""
    if fewer == 0:
        return 1.0
    if reduced is None:
        return 0.0
    least, most = _squares(full, full), _squares(reduced, full)
    return float(stats.f.sf(max(most - least, 0.0) / fewer / max(least / full.freedom, 1.0), fewer, full.freedom))


def _squares(each: ClockFit, full: ClockFit) -> float:
    """Sum of squares over the contacts of the full fit, in units of their errors, each clipped at
    `CLOCK.most_deviations`."""
    used = full.touches & full.in_fit
    z = np.nan_to_num(each.residual, nan=CLOCK.largest_gap)[used] / (full.std[used] * full.dispersion)
    return float((np.clip(z, -CLOCK.most_deviations, CLOCK.most_deviations) ** 2).sum())


def _left_out(tables, start, free: tuple[bool, bool], full: ClockFit) -> np.ndarray:
    """Cross-validated residuals (n,) [m] of the contacts: each from a fit without its launch; nan if there is none."""
    launches, found = np.unique(full.launch), np.full(len(full.launch), np.nan)
    for fold in range(CLOCK.folds):
        skip = launches[fold :: CLOCK.folds]
        each = fit_clock(tables, start, free, skip)
        if each is not None:
            here = np.isin(full.launch, skip)
            found[here] = each.residual[here]
    return found


def _finding(name: str, named, best: ClockFit, fits, chance, full: ClockFit) -> Finding:
    """The finding `name` (delay or drift), with its p-value and its alternative; `named`: all selected ones."""
    index = 0 if name == "camera_delay" else 1
    value = (best.clock.delay, best.clock.rate * 1e6)[index]
    error = float(np.sqrt(best.clock.covariance[index, index])) * (1.0, 1e6)[index]
    half = reach(best.freedom) * error
    unit, label = (("s", "delay_s"), (DRIFT.rows["ppm"].unit, "ppm"))[index]
    without = _chance(fits[("camera_delay", "clock_drift")[1 - index]], full, 1) if len(named) == 2 else chance["none"]
    other = ("camera_delay", "clock_drift")[1 - index]
    estimate = Estimate(value, value - half, value + half, unit)
    alternative = Alternative(
        other, -float(np.log(max(chance[other], 1e-300))), f"alone it is rejected with p = {chance[other]:.1g}"
    )
    other_rejected = len(named) == 2 or chance[other] < CLOCK.rejected
    return Finding(
        regime="sensing",
        mechanism=name,
        also_possible=() if other_rejected else (other,),
        depends_on=("time",) if index else (),
        formula=FORMULAS[name],
        parameters={label: estimate},
        p_value=max(without, 1e-300),
        where={"stream": "frames"} if index else {},
        values={"camera_latency": value} if index == 0 else {},
        ranges={"camera_latency": estimate} if index == 0 else {},
        alternatives=(alternative,) if other_rejected and len(named) == 1 else (),
    )
