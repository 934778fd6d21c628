"""Whether the camera's clock is late or drifts: four clocks are fitted, and the simplest that will do is chosen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.finding import Estimate, Finding, Proof, Rival
from sim2real.diagnose.interval import reach
from sim2real.diagnose.sensing.clock import EXACT, TOUCHED, Clock, Fit, Meetings, fit, search
from sim2real.diagnose.sensing.measured import SURE, measured

MODELS = {"none": (False, False), "camera_delay": (True, False), "clock_drift": (False, True), "both": (True, True)}
DRIFT = EFFECTS["clock_drift"]
FORMULAS = {"camera_delay": "a frame stamped t shows the encoders' time t - delay_s", "clock_drift": DRIFT.law}
REJECTED = 1e-3  # chance at which one of the two errors alone is not enough
LATE_AT_LEAST = 0.0005  # s: less is no more than the jitter of stamps
BETTER = 0.9  # times the gaps as recorded, that the corrected ones must be below in launches that no fit saw
FOLDS = 5  # parts of the launches, for that
WORST = 12.0  # standard deviations; a blow counts no more, however far off


@dataclass(frozen=True)
class ClockAccount:
    """The fit of a clock that blows show (None where nothing is missing), its findings, and how far off launches are
    that a fit did not see, `selection`.

    `told`: whether there were blows enough to see a delay of LATE_AT_LEAST or more of any size that matters.
    """

    fit: Fit | None
    findings: tuple[Finding, ...]
    selection: Proof | None
    told: bool

    @property
    def clock(self) -> Clock:
        """EXACT where nothing is missing."""
        return EXACT if self.fit is None else self.fit.clock


def clock_account(tables: list[Meetings]) -> ClockAccount:
    """What the blows of all recordings (`tables`) say of the camera's clock."""
    nothing = ClockAccount(None, (), None, False)
    tables = [one for one in tables if len(one.t) >= 2]
    if not tables:
        return nothing
    start = search(tables)
    fits = {name: fit(tables, start, free) for name, free in MODELS.items()}
    if fits["both"] is None:
        fits["both"] = fits["camera_delay"]
    full = fits["both"]
    if full is None or full.freedom < 3:
        return nothing
    chance = {name: _chance(each, full, 2 - sum(MODELS[name])) for name, each in fits.items()}
    span = max(float(np.ptp(each.t)) for each in tables)
    name = _choose(chance, full, span)
    told = float(np.sqrt(full.clock.covariance[0, 0])) < 10 * LATE_AT_LEAST
    if name == "none":
        return ClockAccount(None, (), None, told)
    best = fits[name]
    assert best is not None
    before = np.concatenate([each.gaps(np.array(0.0), np.array(0.0))[0] for each in tables])
    before = np.where(full.met, before, np.nan)
    left_out = measured(before, _left_out(tables, start, MODELS[name], full), full.std, full.launch)
    if left_out is None or left_out.proof.after_m > BETTER * left_out.proof.before_m:
        return ClockAccount(None, (), None, told)
    named = ("camera_delay", "clock_drift") if name == "both" else (name,)
    findings = tuple(_finding(each, named, best, fits, chance, full) for each in named)
    return ClockAccount(best, findings, left_out.proof, True)


def _choose(chance: dict[str, float], full: Fit, span: float) -> str:
    """The simplest clock that is not rejected in favour of the full one; none unless an exact one surely is."""
    matters = abs(full.clock.delay) > LATE_AT_LEAST or abs(full.clock.rate) * span > LATE_AT_LEAST
    if chance["none"] > SURE or not matters:
        return "none"
    single = max(("camera_delay", "clock_drift"), key=lambda name: chance[name])
    return single if chance[single] > REJECTED else "both"


def _chance(reduced: Fit | None, full: Fit, fewer: int) -> float:
    """p-value of the reduced clock against the full one: the F test on the squares that either leaves."""
    if fewer == 0:
        return 1.0
    if reduced is None:
        return 0.0
    left, most = _squares(full, full), _squares(reduced, full)
    return float(stats.f.sf(max(most - left, 0.0) / fewer / max(left / full.freedom, 1.0), fewer, full.freedom))


def _squares(each: Fit, full: Fit) -> float:
    """Sum of squares of the blows that met the mallet by the full fit, in units of their errors, none over WORST."""
    used = full.met & full.seen
    z = np.nan_to_num(each.residual, nan=TOUCHED)[used] / (full.std[used] * full.spread)
    return float((np.clip(z, -WORST, WORST) ** 2).sum())


def _left_out(tables, start, free: tuple[bool, bool], full: Fit) -> np.ndarray:
    """Residuals (n,) [m] of the blows, each by a fit that did not see its launch; nan where there is none."""
    launches, found = np.unique(full.launch), np.full(len(full.launch), np.nan)
    for fold in range(FOLDS):
        skip = launches[fold::FOLDS]
        each = fit(tables, start, free, skip)
        if each is not None:
            here = np.isin(full.launch, skip)
            found[here] = each.residual[here]
    return found


def _finding(name: str, named, best: Fit, fits, chance, full: Fit) -> Finding:
    index = 0 if name == "camera_delay" else 1
    value = (best.clock.delay, best.clock.rate * 1e6)[index]
    error = float(np.sqrt(best.clock.covariance[index, index])) * (1.0, 1e6)[index]
    half = reach(best.freedom) * error
    unit, label = (("s", "delay_s"), (DRIFT.rows["ppm"].unit, "ppm"))[index]
    without = _chance(fits[("camera_delay", "clock_drift")[1 - index]], full, 1) if len(named) == 2 else chance["none"]
    other = ("camera_delay", "clock_drift")[1 - index]
    estimate = Estimate(value, value - half, value + half, unit)
    rival = Rival(
        other, -float(np.log(max(chance[other], 1e-300))), f"alone it is rejected with p = {chance[other]:.1g}"
    )
    unlike = len(named) == 2 or chance[other] < REJECTED
    return Finding(
        regime="sensing",
        mechanism=name,
        also_possible=() if unlike else (other,),
        depends_on=("time",) if index else (),
        formula=FORMULAS[name],
        parameters={label: estimate},
        p_value=max(without, 1e-300),
        where={"stream": "frames"} if index else {},
        values={"camera_latency": value} if index == 0 else {},
        ranges={"camera_latency": estimate} if index == 0 else {},
        rivals=(rival,) if unlike and len(named) == 1 else (),
    )
