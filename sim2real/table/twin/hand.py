"""The opponent's hand in the twin: a player that sees the table as it is, and takes the mallet with it."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from baselines.player import Player, Seat
from puckpilot_env.game import mirror
from puckpilot_env.game.start import HOME
from puckpilot_env.kernel import kernel
from puckpilot_env.physics.gantry.plan import plan_mallet
from sim2real.table.backend import Place
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.seated_player import seated_player
from sim2real.table.mallet_driver import planned_volts
from sim2real.table.twin.plant import OpponentPlan, Plant

GAME = ("score", "time", "held", "steps", "defending", "fouls")  # what the opponent may know


class ScriptedHand:
    """A player, by name or itself, at the opponent's seat of a game. ValueError, in one line, for an unknown name."""

    def __init__(self, game: GameRecord, player: str | Player, seed: int) -> None:
        given = {**game.given, "max_voltage": planned_volts(game.p)}  # no stronger than the robot's mallet
        self._game = GameRecord(game.tables.variant, given, seed, period=float(game.rule["period"]))
        seat = Seat.from_tables(self._game.tables, seed)
        self._player = seated_player(player, seat) if isinstance(player, str) else player

    @property
    def home(self) -> Place:
        """Where the mallet is at the beginning of a point [m]."""
        p = self._game.p
        return (1.0 - HOME) * float(p["length"]), 0.5 * float(p["width"])

    def begin_point(self) -> None:
        """A point begins."""
        self._player.reset(np.ones(1, bool))

    def observe(self, plant: Plant, game: np.void) -> NDArray[np.float32]:
        """The opponent's observation (columns,) of the table as it is and the game's record."""
        for name in GAME:
            self._game.record[name] = game[name]
        puck = plant.puck
        if np.isfinite(puck[0]):
            self._game.put_puck((float(puck[0]), float(puck[1]), float(puck[2]), float(puck[3])))
        for which in range(2):
            self._game.put_mallet(which, plant.mallet(which), plant.acceleration(which))
        return self._game.observe()[1]

    def decide(self, plant: Plant, game: np.void) -> OpponentPlan:
        """The plan of the next step, of the table as it is and the game's record."""
        action = self._player.act(self.observe(plant, game)[None])[0]
        mallet = self._game.record["mallets"][1]
        _plan(mallet, self._game.p, *(float(one) for one in action))
        x, y = mallet["x"], mallet["y"]
        return (
            float(x["volts"]), float(y["volts"]), float(x["t1"]), float(y["t1"]), float(x["t2"]), float(y["t2"])
        )  # fmt: skip


@kernel
def _plan(mallet, p, x, y, vx, vy):
    to_x, to_y = mirror.place(1, x, y, p)
    plan_mallet(mallet, to_x, to_y, vx, vy, mirror.area(1, p), p.max_voltage)
