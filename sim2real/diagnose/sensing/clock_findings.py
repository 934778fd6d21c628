"""Whether the camera's clock is late or drifts: four clocks are fitted, and the simplest that will do is chosen."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from scipy import stats

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.finding import Estimate, Finding, Proof, Rival
from sim2real.diagnose.interval import reach
from sim2real.diagnose.sensing.clock import EXACT, TOUCHED, Clock, Fit, Meetings, fit, search
from sim2real.diagnose.sensing.measured import SURE, Measured, measured

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
    """The clock that the blows show (EXACT where nothing is missing), its findings, and their proof.

    `told`: whether there were blows enough to see a delay of LATE_AT_LEAST or more of any size that matters.
    """

    clock: Clock
    findings: tuple[Finding, ...]
    proof: Proof | None
    told: bool


def clock_account(tables: list[Meetings], apart: np.ndarray) -> ClockAccount:
    """What the blows of all recordings (`tables`) say of the camera's clock; those of the launches `apart` prove it."""
    nothing = ClockAccount(EXACT, (), None, False)
    seen = [each for each in (one.without(apart) for one in tables) if len(each.t) >= 2]
    if not seen:
        return nothing
    start = search(seen)
    fits = {name: fit(tables, start, free, apart) for name, free in MODELS.items()}
    if fits["both"] is None:
        fits["both"] = fits["camera_delay"]
    full = fits["both"]
    if full is None or full.freedom < 3:
        return nothing
    chance = {name: _chance(each, full, 2 - sum(MODELS[name])) for name, each in fits.items()}
    span = max(float(np.ptp(each.t)) for each in seen)
    name = _choose(chance, full, span)
    told = float(np.sqrt(full.clock.covariance[0, 0])) < 10 * LATE_AT_LEAST
    if name == "none":
        return ClockAccount(EXACT, (), None, told)
    best = fits[name]
    assert best is not None
    before = np.concatenate([each.gaps(np.array(0.0), np.array(0.0))[0] for each in tables])
    before = np.where(full.met, before, np.nan)
    foretold = measured(before, _foretold(tables, start, MODELS[name], full, apart), full.std, full.launch)
    unseen = measured(before, np.where(full.seen, np.nan, best.residual), full.std, full.launch)
    if foretold is None or foretold.proof.after_m > BETTER * foretold.proof.before_m:
        return ClockAccount(EXACT, (), None, told)
    sizes = unseen or foretold
    named = ("camera_delay", "clock_drift") if name == "both" else (name,)
    findings = tuple(_finding(each, named, best, fits, chance, full, sizes) for each in named)
    return ClockAccount(best.clock, findings, sizes.proof, True)


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


def _foretold(tables, start, free: tuple[bool, bool], full: Fit, apart: np.ndarray) -> np.ndarray:
    """Residuals (n,) [m] of the blows that the full fit saw, each by a fit that did not see its launch; else nan."""
    launches, found = np.unique(full.launch[full.seen]), np.full(len(full.launch), np.nan)
    for fold in range(FOLDS):
        skip = launches[fold::FOLDS]
        each = fit(tables, start, free, np.concatenate([apart, skip]))
        if each is not None:
            here = np.isin(full.launch, skip)
            found[here] = each.residual[here]
    return found


def _finding(name: str, named, best: Fit, fits, chance, full: Fit, sizes: Measured) -> Finding:
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
        before=sizes.before,
        after=sizes.after,
        where={"stream": "frames"} if index else {},
        values={"camera_latency": value} if index == 0 else {},
        ranges={"camera_latency": estimate} if index == 0 else {},
        rivals=(rival,) if unlike and len(named) == 1 else (),
    )
