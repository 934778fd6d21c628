"""Tuned numbers of the measurement of delays."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class ShiftNumbers:
    """Tuned numbers of the shift between two stamped paths of the mallet."""

    longest: float = tuned(
        0.12, "s", "less misses slow cameras, more costs time", "choice: 7 frames of a camera of 60 frames a second"
    )
    grid: float = tuned(0.002, "s", "coarser grids miss the likeliest shift", "choice: 4 mm of a fast mallet")
    most_drift: float = tuned(
        300e-6, "1", "less misses bad clocks, more costs time", "choice: three times a bad crystal's, as of BoardClock"
    )
    searched: int = tuned(400, "samples", "fewer miss the likeliest shift, more cost time", "choice: some strokes")
    hole: float = tuned(0.02, "s", "longer holes hide what the mallet did", "choice: ten samples of the telemetry")
    block: float = tuned(
        0.5,
        "s",
        "shorter blocks are correlated, and intervals too short; longer ones are too few",
        "tests/sim2real/table/latency/test_path_shift.py",
    )
    fewest_blocks: int = tuned(8, "blocks", "fewer make the interval uncertain", "choice: four seconds of motion")
    least_travel: float = tuned(
        0.01, "m", "standard deviation of the path: with less, noise decides", "choice: a hundred times the noise"
    )
    rounds: int = tuned(30, "steps", "fewer end the fit before it converges", "choice: fits converge sooner")


SHIFT = ShiftNumbers()
