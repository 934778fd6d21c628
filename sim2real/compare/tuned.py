"""Tuned numbers of the comparison."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class ComparisonNumbers:
    """Tuned numbers of the selection of segments and of the summary."""

    fitted_part: float = tuned(
        0.4,
        "of a glide",
        "a start that is noise (small), a prediction of next to nothing (large)",
        "choice: under half",
    )
    fewest_fitted: int = tuned(8, "frames", "a start that is noise", "choice: twice its numbers")
    fewest_frames: int = tuned(24, "frames", "a prediction of next to nothing", "choice: 0.2 s at 120 Hz")
    slowest: float = tuned(
        0.05, "m/s", "a puck at rest, of which any law is right", "choice: 6 mm in the shortest glide"
    )
    clear_speed: float = tuned(
        0.1, "m/s", "ratios of speeds that are noise", "choice: several times a velocity's error"
    )
    growth: tuple[float, ...] = tuned(
        (0.1, 0.2, 0.5, 1.0, 2.0), "s", "a growth of errors that no row shows", "choice: about doubling"
    )
    agrees: float = tuned(
        1.5, "times noise", "noise reported as a difference (small), or a difference missed (large)",
        "choice, held by tests/sim2real/compare/test_units_of_noise.py",
    )  # fmt: skip
    few: int = tuned(10, "segments", "an unreliable median without a warning", "choice: two decide its 90 % range")
    many: float = tuned(0.25, "1", "hands on the table, or wrong sizes, without a warning", "choice: a quarter of all")


COMPARISON = ComparisonNumbers()
