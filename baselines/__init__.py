"""Players by name. A file in `baselines/players/` is a scripted player, and its name is the player's name.

A name `KIND:REST` is made by somebody above this package (`KINDS`): `policy:champion`, or `policy:run/policy.npz`.

from baselines import make_player, player_names
from baselines.player import Seat

player = make_player("goalie", Seat.from_tables(tables))
actions = player.act(tables.observations[:, 0])
"""

from __future__ import annotations

import difflib
import importlib
import pkgutil
from collections.abc import Callable

from baselines import players
from baselines.player import Player, Seat

KINDS = {"policy": "agents.policy:find_policy_player"}  # prefix of a name: what finds such a player, loaded when asked

__all__ = ["Player", "Seat", "find_player", "make_player", "player_names"]


def player_names() -> list[str]:
    """Names of all players, sorted: the files of `baselines/players/`."""
    return sorted(name for _, name, _ in pkgutil.iter_modules(players.__path__) if not name.startswith("_"))


def find_player(name: str) -> Callable[[Seat], Player]:
    """What makes the player of this name for a seat. Raises ValueError, in one line, for an unknown name."""
    kind, colon, rest = str(name).partition(":")
    if colon and kind in KINDS:
        module, _, finder = KINDS[kind].partition(":")
        return getattr(importlib.import_module(module), finder)(rest)
    names = player_names()
    if name not in names:
        near = difflib.get_close_matches(str(name), names, n=1)
        hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(names)}, and policy:NAME or policy:FILE"
        raise ValueError(f"unknown player '{name}'; {hint}")
    module = importlib.import_module(f"{players.__name__}.{name}")
    found = [c for c in vars(module).values() if isinstance(c, type) and c.__module__ == module.__name__]
    found = [c for c in found if issubclass(c, Player)]
    if len(found) != 1:
        raise ValueError(f"{module.__file__} defines {len(found)} subclasses of Player; expected one")
    return found[0]


def make_player(name: str, seat: Seat) -> Player:
    """The player of this name, sitting at `seat`. Raises ValueError, in one line, for an unknown name."""
    return find_player(name)(seat)
