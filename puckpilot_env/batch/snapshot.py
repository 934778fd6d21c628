"""Some tables at an instant, and which tables they can be put back onto."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.options.draw_checks import SIZES
from puckpilot_env.options.inputs import in_short
from puckpilot_env.options.randomization import Draw

CLOSE = 1e-12  # share by which a drawn number may be rounded beyond its range


@dataclass(frozen=True, eq=False)
class Snapshot:
    """Some tables at an instant, random streams included. Made by `Tables.snapshot`, taken by `Tables.restore`."""

    variant: str
    states: NDArray[np.void]
    params: NDArray[np.void]
    frames: NDArray[np.void]
    observations: NDArray[np.float32]
    nominal: NDArray[np.void]  # (1,): the parameters before any were drawn


def refuse_foreign(given: object, own: Snapshot, draws: Sequence[Draw], period: float, count: int) -> None:
    """ValueError, in one line, if `given` is no snapshot that `count` of the tables that `own` is of can go on from.

    Sizes must be the same before draws, and after them such as these tables may have; all other parameters, the
    drawn ones among them, are restored with the tables. period: of these tables' steps [s].
    """
    if not isinstance(given, Snapshot):
        raise ValueError(f"snapshot is {in_short(given)}; expected what Tables.snapshot() gives")
    if given.variant != own.variant or given.frames.shape[1:] != own.frames.shape[1:]:
        raise ValueError(f"the snapshot is of {given.variant}; these tables are of another variant or camera")
    for array in fields(Snapshot)[1:]:
        theirs, ours = getattr(given, array.name), getattr(own, array.name)
        if theirs.dtype != ours.dtype or theirs.shape[1:] != ours.shape[1:]:
            raise ValueError(f"the snapshot's {array.name} are of another version of the simulator; take a new one")
    for name in SIZES:
        _refuse_size(given, own, name, [draw for draw in draws if draw.parameter == name])
    delay = given.params["command_delay"].max(initial=0.0)
    if delay >= period:
        raise ValueError(
            f"the snapshot has a command_delay of {delay:g} s; expected less than the period, {period:g} s"
        )
    if len(given.states) not in (1, count):
        raise ValueError(f"the snapshot has {len(given.states)} tables; expected 1 or {count}")


def _refuse_size(given: Snapshot, own: Snapshot, name: str, draws: Sequence[Draw]) -> None:
    theirs, ours = float(given.nominal[name][0]), float(own.nominal[name][0])
    if theirs != ours:
        raise ValueError(f"the snapshot is of tables of {name} {theirs:g} m; expected {ours:g} m, as these have")
    low, high = (draws[0].low, draws[0].high) if draws else (ours, ours)
    values = given.params[name]
    outside = values[~((values >= low * (1.0 - CLOSE)) & (values <= high * (1.0 + CLOSE)))]
    if len(outside):
        expected = f"{low:g} to {high:g} m, as these tables draw it" if draws else f"{ours:g} m, as these tables have"
        raise ValueError(f"the snapshot has a table of {name} {outside[0]:g} m; expected {expected}")
