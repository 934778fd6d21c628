"""How a mallet moves by itself: the simulator's gantry after the aims of a page, which no server corrects."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game import mirror
from puckpilot_env.physics.gantry.mallet import place_at, settle
from puckpilot_env.physics.gantry.plan import plan_mallet
from puckpilot_env.tables import Tables
from sim2real.arena.game import VARIANT

Aim = tuple[float, float, float]  # s, m, m


class OwnMotion:
    """The mallet of seat 0, at rest in its home until it is moved."""

    def __init__(self) -> None:
        tables = Tables(VARIANT, 1, autoreset=False)
        self._p, self._volts = tables.params[0], float(tables.action_bounds[1][2])
        self._mallet = tables.states[0]["mallets"][0]
        self._area, self._most = mirror.area(0, self._p), float(self._p["max_voltage"])

    def places(self, aims: Sequence[Aim], times: Sequence[float]) -> NDArray[np.float64]:
        """Where it is (n, 2) [m] at ascending times [s], if it follows each aim from its time on."""
        found, begun, waiting = [], None, list(aims)
        for time in times:
            while waiting and waiting[0][0] <= time:
                at, x, y = waiting.pop(0)
                if begun is not None:
                    settle(self._mallet, at - begun)
                plan_mallet(self._mallet, x, y, self._volts, self._volts, self._area, self._most)
                begun = at
            found.append(place_at(self._mallet, 0.0 if begun is None else time - begun))
        return np.array(found)
