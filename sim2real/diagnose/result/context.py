"""The context of a diagnosis for its report: recordings and baseline."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from puckpilot_env.parameters import BY_NAME


@dataclass(frozen=True)
class ReportContext:
    """The names of the `recordings`, the holdout included, and the user's `baseline`.

    `baseline`: parameters that replace the simulator's defaults, by their names in `puckpilot_env.parameters`.
    """

    recordings: tuple[str, ...] = ()
    baseline: Mapping[str, float] = field(default_factory=dict)

    @property
    def simulator(self) -> str:
        """The simulator that the recordings are compared with, as the subject of a sentence."""
        return "The simulator with your baseline" if self.baseline else "The simulator with default parameters"

    @property
    def standard(self) -> str:
        """Its parameters, as the head of a column."""
        return "your baseline" if self.baseline else "default"

    @property
    def reference(self) -> str:
        """Its parameters, as the second part of a comparison."""
        return "your baseline" if self.baseline else "the defaults"

    @property
    def these(self) -> str:
        """The recordings as the subject or object of a sentence."""
        return "these recordings" if len(self.recordings) > 1 else "this recording"

    def value(self, name: str) -> float:
        """Return a parameter before any fit."""
        return self.baseline.get(name, BY_NAME[name].default)


PLAIN = ReportContext()  # one recording, compared with the default parameters
