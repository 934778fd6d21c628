"""The twin as a backend, in lock-step: time passes only in `wait`, and the same seed gives the same game."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from dataclasses import fields, replace
from typing import Any

import numpy as np

from baselines.player import Player
from puckpilot_env.options.inputs import in_short
from puckpilot_env.parameters import TABLE
from sim2real.study.independent_table.physics.law import Law
from sim2real.table.backend import Place
from sim2real.table.board_config import board_config
from sim2real.table.board_line import BoardLine
from sim2real.table.game.game_record import GameRecord
from sim2real.table.live_table import LiveTable
from sim2real.table.mallet_driver import AHEAD
from sim2real.table.twin.board import BoardErrors, EmulatedBoard
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.cameras import camera_maker
from sim2real.table.twin.hand import ScriptedHand
from sim2real.table.twin.plant import Plant

MODELLED = tuple(row.name for row in TABLE if row.name in {field.name for field in fields(Law)})  # of the baseline
WAKING = 1e-6  # s from a frame until the host is awake, more than a tick of the clock
CARRYING = 1.0  # m/s at which a hand takes the robot's mallet home


class Twin(LiveTable):
    """A table with a scripted hand at the other end; see `backend.Backend`.

    game: whose table it is; opponent: a player, by name or itself; law: physics of the plant, as the game's parameters
    say by default; errors: of the camera; camera: "places" or "pictures"; board_errors: of the board's clock and
    line; command_delay: of the motors, that the board allows for [s]. ValueError, in one line, for an unknown name.
    onlooker: takes the plant as it is, whenever the camera exposes a frame; it may be set at any time.
    """

    onlooker: Callable[[Plant], None] | None = None

    def __init__(
        self,
        game: GameRecord,
        opponent: str | Player = "goalie",
        law: Law | None = None,
        errors: CameraErrors | None = None,
        camera: str = "places",
        board_errors: BoardErrors | None = None,
        command_delay: float | None = None,
    ) -> None:
        for name, given, kind in (("law", law, Law), ("errors", errors, CameraErrors),
                                  ("board_errors", board_errors, BoardErrors)):  # fmt: skip
            if given is not None and not isinstance(given, kind):
                raise ValueError(f"{name} is {in_short(given)}; expected a {kind.__name__} of {kind.__module__}")
        errors, self._seed = errors or CameraErrors(), 0
        super().__init__(board_config(game.p, command_delay=command_delay or 0.0), errors.rate)
        self._make_camera = camera_maker(camera, game.p, errors)
        refuse_unmodelled(game.given)
        self.p, self._law, self._board_errors = game.p, law or law_of(game.p), board_errors
        self._reaction = AHEAD if isinstance(opponent, str) else 0.0  # s from `play` until the hand decides
        self._decision: tuple[float, np.void] | None = None  # when the hand decides next, by which state of the game
        self._holds_puck = False
        self._make_hand = lambda seed: ScriptedHand(game, opponent, 2 * seed + 1)
        self.hand = self._make_hand(self._seed)
        self.board: EmulatedBoard | None = None

    def seed(self, seed: int) -> None:
        """Noise, the hand and the board's memory begin anew."""
        self._seed = seed
        self.hand = self._make_hand(seed)

    def open(self, home: Place) -> None:
        """Switch board and camera on."""
        self._decision = None
        self.plant = Plant(self._law, home, self.hand.home)
        self.board = EmulatedBoard(self.plant, float(self.p["max_voltage"]), self._seed, self._board_errors)
        self.eyes = self.camera = self._make_camera(self._seed)
        self.line = BoardLine(lambda: self._opened(self.board), self.now, lambda until: self.pass_time(until))
        self.person = self

    def now(self) -> float:
        """Virtual time since power-on [s]."""
        return self._opened(self.board).now()

    @property
    def next_frame(self) -> float:
        """See `LiveTable.next_frame`: a host that waits for a frame wakes up as it comes."""
        return self.camera.next_frame + WAKING

    def pass_time(self, until: float) -> None:
        """Let virtual time pass, with the frames and the hand's decision that are due."""
        board = self._opened(self.board)
        while True:
            decision = self._decision[0] if self._decision else math.inf
            due = min(self.camera.next_exposure, decision)
            if due > until:
                break
            board.run(due)
            if due == self.camera.next_exposure:
                self.camera.expose(self.plant)
                if self.onlooker:
                    self.onlooker(self.plant)
            elif self._decision:
                (_, game), self._decision = self._decision, None
                self._let_puck_go()
                self.plant.play(self.hand.decide(self.plant, game))
        board.run(until)

    def _shut(self) -> None:
        if self.board is not None:
            self.board.machine.close()
        self.board = None

    # The person at the table: the hand

    def put_puck(self, puck: np.ndarray) -> None:
        """The hand puts its mallet home and the puck down. One at rest it holds until play goes on, as the simulator
        does: from a tilted table it would else have moved before the first decision."""
        self._decision = None
        self.plant.put_puck(puck)
        self._holds_puck = not puck[2:].any()
        self.plant.jam(self._holds_puck)
        self.plant.put_opponent(self.hand.home)
        self.hand.begin_point()

    def _let_puck_go(self) -> None:
        if self._holds_puck:
            self._holds_puck = False
            self.plant.jam(False)

    def home_mallet(self, home: Place) -> None:
        """The hand takes the robot's mallet home, no faster than encoders can count."""
        line = self._opened(self.line)
        here = np.array(self.plant.mallet(0)[:2])
        steps = int(np.ceil(float(np.hypot(*(here - home))) / (CARRYING * 1e-3)))
        for part in (np.arange(steps) + 1.0) / max(steps, 1):
            self.plant.put_robot(tuple(here + part * (np.array(home) - here)))
            self.pass_time(self.now() + 1e-3)
            line.poll()

    def play(self, game: np.void) -> None:
        """The hand decides what to do next: as in the simulator, at the moment at which the robot's action acts. An
        action that is given from outside acts at once, for it is of the table as it is now."""
        self._decision = self.now() + self._reaction, game.copy()


def refuse_unmodelled(parameters: Mapping[str, float]) -> None:
    """ValueError, in one line, for a parameter that the plant's law does not have, or under another name."""
    for name in parameters:
        if name not in MODELLED:
            raise ValueError(f"the twin does not model '{name}'; it takes {', '.join(MODELLED)}")


def law_of(p: np.void) -> Law:
    """The independent table's law with the baseline's numbers as the parameters say."""
    numbers: dict[str, Any] = {name: float(p[name]) for name in MODELLED}
    return replace(Law(), **numbers)
