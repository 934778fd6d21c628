"""Tuned numbers of the identification."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class GantryNumbers:
    """Free runs of the gantry, their fit, and the choice of a law."""

    past: float = tuned(
        0.02, "s", "a state that noise, or an old one that the law, decides", "choice: ten rows of telemetry"
    )
    warm_up: float = tuned(0.1, "s", "volts and friction that are not known yet", "choice: many fast modes")
    fitted: tuple[float, ...] = tuned(
        (0.01, 0.02, 0.04, 0.06, 0.08, 0.1, 0.125, 0.15, 0.175, 0.2),
        "s",
        "a fit to what decays at once, or to what a disturbance carried away",
        "choice: a period of play and twice that",
    )
    judged: tuple[float, ...] = tuned(
        (0.05, 0.1, 0.2, 0.5), "s", "a law that is good for one moment", "choice: some periods"
    )
    age: float = tuned(0.02, "s", "late errors, which are larger, deciding all", "choice: weight 1 / (time + age)")
    fit_every: float = tuned(0.1, "s", "a slow fit, or windows left out", "choice: the next begins inside the last")
    judge_every: float = tuned(0.02, "s", "a slow or a coarse judgement", "choice")
    longest_step: float = tuned(0.003, "s", "steps too coarse for the fast mode", "choice: twice a late row's")
    least_way: float = tuned(
        0.01,
        "m",
        "less fits constants to the encoders' noise; more refuses logs of small moves",
        "choice: a hundred times the encoders' steps",
    )
    fewest_windows: int = tuned(20, "1", "a fit of as many numbers as windows", "choice: one more than the numbers")
    parts: int = tuned(5, "1", "a single log that cannot be cross-validated", "choice: as many as a usual set of logs")
    noise: float = tuned(5e-5, "m", "the belt's state from noise", "rows at rest: 20 um, vibration 100 um")
    stretch: float = tuned(3e-4, "m", "a stretch of the belt from noise", "choice: that of 3 V on a belt of 30 Hz")
    stretch_rate: float = tuned(0.05, "m/s", "the same of its rate", "choice: the stretch times 2 pi 30 Hz")
    presliding: float = tuned(2e-4, "m", "friction that is elastic, or steps that are unstable", "choice: a few quanta")
    least_gain: float = tuned(0.02, "1", "laws that grow without use", "choice: smaller gains mean nothing")
    gain_errors: float = tuned(2.0, "standard errors", "laws kept by luck", "choice: 95 %")
    block: float = tuned(1.0, "s", "intervals from residuals that are one event", "choice: five windows' lengths")
    widest: float = tuned(0.5, "1", "numbers that look sure", "choice: half width as part of the value")
    difference: float = tuned(1e-3, "1", "derivatives of rounding or of curvature", "choice: of a number's scale")
    tolerance: float = tuned(1e-5, "1", "fits that end early or never", "choice: of the sum of squares")
    near: float = tuned(1e-4, "1", "the same of fits that begin at the fit to all logs", "choice: 0.005 % of an rms")
    evaluations: int = tuned(30, "1", "fits that never end", "choice: three times what real logs take")


GANTRY = GantryNumbers()
