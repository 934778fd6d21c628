"""Players by name. A file in `baselines/players/` is a scripted player, and its name is the player's name.

Any other player is a class of the caller's own, `module:Class`, or a policy, which the package above this one finds:
`policy:champion`, an .npz or .onnx file, or a run's folder; `agents.policy.policy.policy_file` says how one is named.

- `player`: what a player is and what it knows; `observation_decoder`: present positions and velocities out of an
  observation.
- `players`: the scripts, a file each; `planning`: how they aim, block and search.
- `matches`: paired games, tournaments and drills; `ratings`: intervals and Elo ratings from their results.
- `opponents`: who plays the other seat of an environment, at each table another one if asked for.
- `gymnasium_seat`: one seat as a Gymnasium environment; `commands`: `puckpilot match` and `tournament`.

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
from functools import partial
from typing import Any

from baselines import players
from baselines.player import Player, Seat
from puckpilot_env.options.module_attribute import import_callable, is_module_attribute

POLICIES = "agents.policy.policy"  # of a package above this one, so loaded only when a name is no script's

__all__ = ["Player", "Seat", "find_player", "full_name", "make_player", "player_names"]


def player_names() -> list[str]:
    """Names of all scripted players, sorted: the files of `baselines/players/`."""
    return sorted(name for _, name, _ in pkgutil.iter_modules(players.__path__) if not name.startswith("_"))


def find_player(name: str) -> Callable[[Seat], Player]:
    """A function that makes the player of this name for a seat. ValueError, in one line, for an unknown name."""
    if is_module_attribute(str(name)) and not name.startswith(importlib.import_module(POLICIES).PREFIX):
        return partial(_own_player, name, import_callable(name, "a Player for a Seat"))
    if name not in player_names():
        return _policy_player(str(name))
    module = importlib.import_module(f"{players.__name__}.{name}")
    found = [c for c in vars(module).values() if isinstance(c, type) and c.__module__ == module.__name__]
    found = [c for c in found if issubclass(c, Player)]
    if len(found) != 1:
        raise ValueError(f"{module.__file__} defines {len(found)} subclasses of Player; expected one")
    return found[0]


def full_name(name: str) -> str:
    """The canonical name of a player that has several: a script's name, or a policy's with the prefix `policy:`.

    ValueError, in one line, for an unknown name.
    """
    find_player(name)
    if name in player_names() or is_module_attribute(name):
        return name
    prefix = importlib.import_module(POLICIES).PREFIX
    return f"{prefix}{name.removeprefix(prefix)}"


def make_player(name: str, seat: Seat) -> Player:
    """The player of this name at `seat`. ValueError, in one line, for an unknown name."""
    return find_player(name)(seat)


def _own_player(name: str, make: Callable[..., Any], seat: Seat) -> Player:
    player = make(seat)
    if not (callable(getattr(player, "reset", None)) and callable(getattr(player, "act", None))):
        raise ValueError(f"'{name}' makes a {type(player).__name__}; expected a Player, with reset and act")
    return player


def _policy_player(name: str) -> Callable[[Seat], Player]:
    policies = importlib.import_module(POLICIES)
    if policies.is_policy(name):
        return policies.find_policy_player(name)
    known = [*player_names(), *policies.policy_names()]
    near = difflib.get_close_matches(name, known, n=1)
    hint = (
        f"did you mean '{near[0]}'?"
        if near
        else f"known: {', '.join(known)}, a policy's .npz file, a run's folder, module:Class"
    )
    raise ValueError(f"unknown player '{name}'; {hint}")
