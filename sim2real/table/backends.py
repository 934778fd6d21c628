"""Backends by name: a row each."""

from __future__ import annotations

import difflib
import importlib
import inspect
from collections.abc import Mapping
from typing import Any

from sim2real.table.backend import Backend
from sim2real.table.game.game_record import GameRecord

BACKENDS = {  # name -> module and class, loaded when asked for
    "twin": ("sim2real.table.twin.twin", "Twin"),
    "table": ("sim2real.table.physical.physical_table", "PhysicalTable"),
    "replay": ("sim2real.table.replay.replay", "Replay"),
}
NEEDS = {"unicorn": "the twin needs unicorn; install it with: pip install 'puckpilot[emulate]'"}


def make_backend(name: str, game: GameRecord, **options: Any) -> Backend:
    """The backend of this name for a game, with its own options. ValueError, in one line, for an unknown name or
    option, and where it cannot be made."""
    refuse_unknown_backend(name)
    module, kind = BACKENDS[name]
    try:
        make = getattr(importlib.import_module(module), kind)
    except ModuleNotFoundError as error:
        if error.name not in NEEDS:
            raise
        raise ValueError(NEEDS[error.name]) from None
    takes = {word: row for word, row in inspect.signature(make).parameters.items() if word != "game"}
    if unknown := [word for word in options if word not in takes]:
        raise ValueError(f"{unknown[0]} is given with backend '{name}'; it takes {', '.join(takes)}")
    needs = [word for word, row in takes.items() if row.default is inspect.Parameter.empty]
    if missing := [word for word in needs if word not in options]:
        raise ValueError(f"backend '{name}' needs {missing[0]}; give {missing[0]}=...")
    return make(game, **options)


def stated_parameters(name: str, options: Mapping[str, Any]) -> dict[str, float] | None:
    """The table's parameters as a backend's own file or recording states them, by its options; None for one without
    such. ValueError or OSError, in one line, for a file that cannot be read."""
    if name == "table" and options.get("table") is not None:
        from sim2real.table.physical.table_file import read_table_file

        return read_table_file(options["table"]).parameters
    if name == "replay" and options.get("recording") is not None:
        from sim2real.recording.folder import read_recording
        from sim2real.recording.table_parameters import stated_sizes

        return stated_sizes(read_recording(options["recording"]))
    return None


def refuse_unknown_backend(name: str) -> None:
    """ValueError, in one line, for a name that no backend has."""
    if name not in BACKENDS:
        near = difflib.get_close_matches(str(name), BACKENDS, n=1)
        known = ", ".join(BACKENDS)
        raise ValueError(f"unknown backend '{name}'; " + (f"did you mean '{near[0]}'?" if near else f"known: {known}"))
