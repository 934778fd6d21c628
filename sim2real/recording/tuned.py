"""Tuned numbers of reading a recording: how wrong a file may be before it is refused or noted."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class RecordingNumbers:
    """Limits of what can be meant in SI units, and of what may differ."""

    largest_position: float = tuned(1e3, "m or V", "values in other units, or overflow", "choice: no table is so large")
    largest_time: float = tuned(1e11, "s", "stamps in other units", "choice: above those of a clock since 1970 in s")
    beyond_end: float = tuned(0.35, "m", "a puck in a goal taken for a blunder", "choice: deeper than a goal")
    beyond_side: float = tuned(0.12, "m", "a puck that climbs a rail taken for a blunder", "choice: about four radii")
    rate_factor: float = tuned(50.0, "1", "stamps in ms or frames", "choice: a fifth of what ms at 240 Hz are off by")
    largest_file: int = tuned(1 << 30, "bytes", "memory that runs out", "choice: days of frames")
    written_to: float = tuned(1e-6, "1", "one size written twice taken for two", "choice: six digits")
    measured_to: float = tuned(0.01, "1", "a size measured anew taken for another gantry's", "choice: one per cent")


RECORDING = RecordingNumbers()
