"""What a diagnosis was asked about, for those who put it into words."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

from puckpilot_env.parameters import BY_NAME


@dataclass(frozen=True)
class ReportContext:
    """The names of the `recordings`, held-out ones among them, and the `baseline`: numbers that were given in place of
    the simulator's own, by their names in `puckpilot_env.parameters`."""

    recordings: tuple[str, ...] = ()
    baseline: Mapping[str, float] = field(default_factory=dict)

    @property
    def simulator(self) -> str:
        """Whose numbers the recordings were held against."""
        return "The simulator with your baseline" if self.baseline else "The simulator as shipped"

    @property
    def standard(self) -> str:
        """The same numbers, in the words of a comparison or of a table's head."""
        return "your baseline" if self.baseline else "shipped"

    @property
    def these(self) -> str:
        """The recordings as the subject of a sentence, in which they are one thing."""
        return "these recordings" if len(self.recordings) > 1 else "this recording"

    def value(self, name: str) -> float:
        """A parameter as it was before anything was fitted."""
        return self.baseline.get(name, BY_NAME[name].default)


PLAIN = ReportContext()  # one recording, held against the simulator as shipped
