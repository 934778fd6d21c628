"""Tuned numbers of reading a recording: limits beyond which a file is refused or a warning is noted."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class RecordingNumbers:
    """Limits of plausible values in SI units, and tolerances between recordings."""

    largest_position: float = tuned(1e3, "m or V", "values in other units, or overflow", "choice: no table is so large")
    largest_time: float = tuned(1e11, "s", "stamps in other units", "choice: above those of a clock since 1970 in s")
    beyond_end: float = tuned(0.35, "m", "a puck in a goal taken for a gross error", "choice: deeper than a goal")
    beyond_side: float = tuned(0.12, "m", "a puck on a rail taken for a gross error", "choice: about four radii")
    rate_factor: float = tuned(50.0, "1", "stamps in ms or frames", "choice: a fifth of the factor for ms at 240 Hz")
    largest_file: int = tuned(1 << 30, "bytes", "memory that runs out", "choice: days of frames")
    written_to: float = tuned(1e-6, "1", "one size written twice taken for two", "choice: six digits")
    measured_to: float = tuned(0.01, "1", "a size measured anew taken for another gantry's", "choice: one per cent")


RECORDING = RecordingNumbers()
