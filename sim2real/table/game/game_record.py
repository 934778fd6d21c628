"""The state of a game as the simulator's record, written from what is known of a table, and the observations of it."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game import sensing
from puckpilot_env.game.sight import look_now
from puckpilot_env.game.start import MATCH
from puckpilot_env.game.state import FRAME
from puckpilot_env.game.step import observe_table
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.mallet import idle, place_axis
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant
from sim2real.table.backend import Motion

SHORTEST = 0.016  # s between two decisions: the board looks at a plan for 10 ms, and frames come every 8.3 ms


class GameRecord:
    """A record of one table of a variant, in whose places the caller writes what it knows.

    `tables`: a simulator's table of its own, for spaces, columns and rules; nothing is stepped in it; `given`: the
    parameters that were named; `rows`: record, parameters and rules as arrays of one row each, which a kernel takes ten
    times as fast as the rows themselves; `period`: of a step [s], SHORTEST at least, the variant's by default.
    ValueError, in one line, for drills, and for variants that draw their table or show camera frames: no backend plays
    them yet.
    """

    def __init__(
        self,
        variant: Variant | str,
        parameters: Mapping[str, float] | None = None,
        seed: int = 0,
        *,
        period: float | None = None,
    ) -> None:
        self.given = dict(parameters or {})
        self.tables = Tables(variant, 1, seed=seed, autoreset=False, parameters=parameters, period=period)
        rules = self.tables.variant.rules()[:1]
        self.rule = rules[0]
        if self.rule["sensing"] != sensing.EXACT or self.rule["game"] != MATCH or self.tables.variant.draws:
            raise ValueError(
                f"a table backend plays puckpilot/match-v0; {self.tables.variant.id} is not played there yet"
            )
        if float(self.rule["period"]) < SHORTEST:
            raise ValueError(f"period is {float(self.rule['period']):g} s; the board takes a plan every {SHORTEST:g} s")
        self.record, self.p = self.tables.states[0], self.tables.params[0]
        self.rows = self.tables.states[:1], self.tables.params[:1], rules
        self._no_frames = np.zeros(1, FRAME)

    def put_puck(self, puck: Motion) -> None:
        """Write the puck's motion."""
        for name, value in zip(("x", "y", "vx", "vy"), puck, strict=True):
            self.record["puck"][name] = value

    def put_mallet(self, which: int, motion: Motion, acceleration: tuple[float, float] = (0.0, 0.0)) -> None:
        """Write the motion of the robot's (0) or the opponent's mallet (1), in the table's frame; with its acceleration
        [m/s^2] where that is known."""
        _put_mallet(self.record["mallets"][which], *motion, *acceleration)

    def observe(self) -> NDArray[np.float32]:
        """The observations (2, columns) of both players."""
        tables = self.tables
        states, params, rules = self.rows
        _observe(
            states, params, tables.nominal, rules, self._no_frames, tables.observation_bounds, tables.observations[0]
        )  # fmt: skip
        return tables.observations[0].copy()


@kernel
def _observe(states, params, nominal, rules, frames, bounds, observations):
    look_now(states[0])  # what a caller writes is what is known, however old it is
    observe_table(states[0], params[0], nominal[0], rules[0], frames, bounds, observations)


@kernel
def _put_mallet(mallet, x, y, vx, vy, ax, ay):
    place_axis(mallet.x, x, vx, ax)
    place_axis(mallet.y, y, vy, ay)
    idle(mallet.x)
    idle(mallet.y)
