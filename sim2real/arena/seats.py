"""Who sits at a table of the arena: a player by name, which decides as often as in training, or a person's pointer."""

from __future__ import annotations

from collections.abc import Callable
from functools import lru_cache
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from baselines import Player, Seat, find_player
from puckpilot_env.game import mirror
from puckpilot_env.physics.gantry.plan import SMALLEST_VOLTAGE
from puckpilot_env.tables import Tables
from sim2real.arena.placement import Placement
from sim2real.arena.quick_mallet import quicken

CONSTANTS = ("slow_rate", "fast_rate", "rest_gain", "slow_gain", "fast_gain")  # of an axis
MODES = ("rest", "slow", "fast")


class Chair(Protocol):
    """One of both seats; `name`: who sits there."""

    name: str

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """The action (4,) of a tick, for what the seat observes (d,)."""
        ...


class PlayerChair:
    """A player by name, whose decision holds for the period of its variant, as in training."""

    def __init__(self, name: str, tables: Tables, ticks: int, seed: int) -> None:
        """ticks: of one decision. ValueError, in one line, for an unknown player."""
        self.name, self._ticks = name, ticks
        self._player = _maker(name)(Seat.from_tables(tables, seed))
        self._player.reset(np.ones(1, np.bool_))
        self._held = np.zeros(4, np.float32)

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """See `Chair`."""
        if tick % self._ticks == 0:
            self._held = self._player.act(observation[None].copy())[0]
        return self._held


@lru_cache
def _maker(name: str) -> Callable[[Seat], Player]:
    """What makes the player of this name for a seat. A policy's file is read once: games would wait for that."""
    return find_player(name)


class PersonChair:
    """A person's pointer, in the table's frame; the mallet goes there as fast as the gantry may."""

    def __init__(self, name: str, tables: Tables, seat: int, quick: bool = False) -> None:
        """quick: without the gantry's limits; `law`: by what a page moves the mallet, see `_law`."""
        if quick:
            quicken(tables, seat)
        self.name, self._seat, self._tables = name, seat, tables
        self._low, self._high = tables.action_bounds
        self._size = np.array([tables.params["length"][0], tables.params["width"][0]])
        self._target = np.array([0.25 * self._size[0], 0.5 * self._size[1]])
        self._stamp, self._acted, self._age = 0.0, 0.0, 0  # of the aim; of that acted on, and for how many ticks
        self._placement, self._placed = Placement(self._mallet(), tables.variant.period), 0
        self.law = _law(tables, seat)

    def aim(self, x: float, y: float, stamp: float = 0.0) -> None:
        """Where the pointer is [m], and was at `stamp`, by the page's clock [ms]."""
        place = np.array([x, y])
        self._target, self._stamp = place if self._seat == 0 else self._size - place, stamp

    def forget_stamp(self) -> None:
        """Another page comes, whose clock is another one."""
        self._stamp = self._acted = 0.0

    def action(self, observation: NDArray[np.float32], tick: int) -> NDArray[np.float32]:
        """See `Chair`."""
        if self._stamp != self._acted:
            self._acted, self._age = self._stamp, 0
        action = np.array([*self._target, *self._high[2:]], np.float32)
        return np.clip(action, self._low, self._high)

    def ticked(self) -> None:
        """The action of `action` was played."""
        self._age += 1
        self._placed += self._placement.ticked(self._mallet())

    def _mallet(self) -> np.void:
        mallet: np.void = self._tables.states[0]["mallets"][self._seat]
        return mallet

    def followed(self) -> dict[str, Any]:
        """What a page needs to correct the mallet that it moves by itself: the stamp of the aim that was acted on, for
        how many ticks, the modes [m] of x and y, and how often the mallet was placed anew."""
        axes = self._mallet()
        own = [[round(float(axes[axis][mode]), 6) for mode in MODES] for axis in "xy"]
        return {"aim": self._acted, "age": self._age, "own": own, "placed": self._placed}


def _law(tables: Tables, seat: int) -> dict[str, Any]:
    """By what a page moves the mallet: constants of x and y, volts, and the least and greatest targets [m]."""
    p, axes = tables.params[0], tables.states[0]["mallets"][seat]
    constants = [{name: float(axes[axis][name]) for name in CONSTANTS} for axis in "xy"]
    limit = 2.0 * (float(p["max_voltage"]) - SMALLEST_VOLTAGE)
    margins = [2.0 * one["fast_gain"] * limit for one in constants]  # as in `plan.settle_voltages`
    area = mirror.area(seat, p)
    return {
        "axes": constants, "volts": min(float(tables.action_bounds[1][2]), 0.5 * limit),
        "low": [float(area[2 * a]) + margins[a] for a in range(2)],
        "high": [float(area[2 * a + 1]) - margins[a] for a in range(2)],
    }  # fmt: skip
