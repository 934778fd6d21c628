"""The table of a circle: a twin whose physics is concealed, or the physical one of a table.toml, whose truth nobody
knows."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from puckpilot_env.files.toml_file import refuse_unknown
from sim2real.table.physical.table_file import read_table_file
from sim2real.table.twin.concealed import TABLES, ConcealedTable, find_table

TWIN, PHYSICAL = "twin", "table"
BACKENDS = {TWIN: "a twin whose physics is concealed", PHYSICAL: "the physical table of a table.toml"}
PERSON = "person"  # who is at the other end of a physical table
_NAMES = f"a name: {', '.join(TABLES)}"


@dataclass(frozen=True)
class GapTable:
    """words: of the table; concealed: what it conceals, None of a physical one; parameters: of the simulator, by name,
    that its file states."""

    words: str
    concealed: ConcealedTable | None = None
    parameters: Mapping[str, float] = field(default_factory=dict)


def find_gap_table(backend: str, table: str) -> GapTable:
    """The concealed table of a name, or the physical one of a file. ValueError, in one line, for an unknown backend or
    name, and for a file that is none."""
    refuse_unknown([backend], BACKENDS, "backend")
    if backend == TWIN:
        if Path(table).suffix == ".toml":
            raise ValueError(f"--table is the file {table}, which --backend table takes; without that, {_NAMES}")
        concealed = find_table(table)
        return GapTable(concealed.words, concealed)
    return GapTable(f"the physical table of {table}", parameters=read_table_file(table).parameters)
