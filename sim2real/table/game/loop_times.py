"""When decisions were made, and on how old a frame: counted, and shown as a histogram."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np

OVERRUN = 0.005  # s after its moment at which a decision counts as an overrun
BINS = 12
BAR = 40  # characters of the fullest bin


@dataclass
class LoopTimes:
    """Times of all decisions of a game [s].

    lateness: after the moment at which a decision was due; frame_ages: of the newest frame at each decision.
    """

    lateness: list[float] = field(default_factory=list)
    frame_ages: list[float] = field(default_factory=list)

    def add(self, late: float, frame_age: float) -> None:
        """Count a decision."""
        self.lateness.append(late)
        self.frame_ages.append(frame_age)

    @property
    def overruns(self) -> int:
        """The number of decisions that came more than OVERRUN late."""
        return int((np.array(self.lateness) > OVERRUN).sum())

    def join(self, other: LoopTimes) -> None:
        """Add the decisions of another game."""
        self.lateness += other.lateness
        self.frame_ages += other.frame_ages


def summary(name: str, seconds: list[float]) -> dict[str, float]:
    """Median, 99 % and greatest of times [s], by `name_median` and so on; nan without any."""
    values = np.array(seconds)[np.isfinite(seconds)] if seconds else np.zeros(0)
    if not len(values):
        return {f"{name}_{word}": float("nan") for word in ("median", "p99", "max")}
    found = np.percentile(values, [50.0, 99.0, 100.0])
    return {f"{name}_{word}": float(value) for word, value in zip(("median", "p99", "max"), found, strict=True)}


def histogram(title: str, seconds: list[float]) -> list[str]:
    """Lines of a histogram of times [s], in ms; the last bin holds all that are longer."""
    values = 1e3 * np.array(seconds)[np.isfinite(seconds)] if seconds else np.zeros(0)
    if not len(values):
        return [f"{title}: none"]
    top = max(float(np.percentile(values, 99.5)), 1e-3)
    edges = np.linspace(min(float(values.min()), 0.0), top, BINS + 1)
    counts = np.histogram(np.minimum(values, top), edges)[0]
    width = len(f"{edges[-1]:.1f}")
    lines = [f"{title} [ms], {len(values)} in all"]
    for low, high, count in zip(edges[:-1], edges[1:], counts, strict=True):
        bar = "#" * int(np.ceil(BAR * count / counts.max()))
        lines.append(f"  {low:{width}.1f} to {high:{width}.1f}  {count:6d}  {bar}".rstrip())
    return lines
