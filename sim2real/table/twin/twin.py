"""The twin as a backend, in lock-step: time passes only in `wait`, and the same seed gives the same game."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import fields, replace

import numpy as np

from puckpilot_env.parameters import TABLE
from puckpilot_env.variants import Variant
from sim2real.study.independent_table.physics.law import Law
from sim2real.table.backend import Place, Reading, TableFaultError
from sim2real.table.board_line import POLL, BoardLine, board_config
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.twin.board import EmulatedBoard
from sim2real.table.twin.camera import CameraErrors, TwinCamera
from sim2real.table.twin.hand import ScriptedHand
from sim2real.table.twin.plant import Plant

MODELLED = tuple(row.name for row in TABLE if row.name in {field.name for field in fields(Law)})  # of the baseline
BLIND = 0.05  # s without a new frame after which the camera counts as lost


class Twin:
    """A table with a scripted hand at the other end; see `backend.Backend`.

    variant, parameters: of the game; opponent: a player's name; law: physics of the plant, as the parameters say by
    default; camera: its errors. ValueError, in one line, for an unknown name.
    """

    def __init__(
        self,
        p: np.void,
        variant: Variant | str,
        opponent: str,
        *,
        parameters: Mapping[str, float] | None = None,
        law: Law | None = None,
        camera: CameraErrors | None = None,
        seed: int = 0,
    ) -> None:
        self._p, self._law = p, law or law_of(p)
        self._errors, self._seed = camera or CameraErrors(), seed
        refuse_unmodelled(parameters)
        self._make_hand = lambda seed: ScriptedHand(variant, opponent, parameters, 2 * seed + 1)
        self.hand = self._make_hand(seed)
        self.board: EmulatedBoard | None = None
        self.line: BoardLine | None = None

    def connect(self, home: Place) -> None:
        """Switch board and camera on, home and arm."""
        self.plant = Plant(self._law, home, self.hand.home)
        self.board = EmulatedBoard(self.plant, float(self._p["max_voltage"]), self._seed)
        self.camera = TwinCamera(self._errors, self._seed)
        self._since = self.board.now()  # the newest frame's arrival
        self.line = BoardLine(lambda: self._board, self.now, self._run)
        self.line.bring_up(board_config(self._p), home)

    @property
    def _line(self) -> BoardLine:
        if self.line is None:
            raise TableFaultError("the twin is not connected; call connect() first")
        return self.line

    @property
    def _board(self) -> EmulatedBoard:
        if self.board is None:
            raise TableFaultError("the twin is not connected; call connect() first")
        return self.board

    def seed(self, seed: int) -> None:
        """Noise, the hand and the board's memory begin anew."""
        self._seed = seed
        self.hand = self._make_hand(seed)

    def now(self) -> float:
        """Virtual time since power-on [s]."""
        return self._board.now()

    def _run(self, until: float) -> None:
        """Let time pass, with the frames that are due."""
        while self.camera.next_exposure <= until:
            self._board.run(self.camera.next_exposure)
            self.camera.expose(self.plant)
        self._board.run(until)

    def wait(self, until: float) -> None:
        """Let virtual time pass until `until` [s], and serve the line."""
        while self.now() < until - 1e-9:
            self._run(min(self.now() + POLL, until))
            self._line.poll()

    def read(self) -> Reading:
        """What came since the last call."""
        self._line.check()
        frames, now = self.camera.take(self.now()), self.now()
        if frames:
            self._since = now
        elif now - self._since > BLIND:
            raise TableFaultError(f"no frame for {1e3 * (now - self._since):.0f} ms; check the camera and begin anew")
        late = now - frames[-1].time if frames else math.nan
        return Reading(frames, late, self._line.take_off_path())

    def send(self, plan: MalletPlan) -> None:
        """Send a plan to the board."""
        self._line.send(plan)

    def place_puck(self, puck: np.ndarray) -> None:
        """The hand puts the puck down and its mallet home."""
        self.plant.put_puck(puck)
        self.plant.put_opponent(self.hand.home)
        self.hand.begin_point()

    def show(self, game: np.void) -> None:
        """The hand decides what to do next."""
        self.plant.play(self.hand.decide(self.plant, game))

    def close(self) -> None:
        """Stop, and drop the board."""
        if self.line is not None:
            self.line.close()
        self.board = self.line = None


def refuse_unmodelled(parameters: Mapping[str, float] | None) -> None:
    """ValueError, in one line, for a parameter that the plant's law does not have, or under another name."""
    for name in parameters or ():
        if name not in MODELLED:
            raise ValueError(f"the twin does not model '{name}'; it takes {', '.join(MODELLED)}")


def law_of(p: np.void) -> Law:
    """The independent table's law with the baseline's numbers as the parameters say."""
    return replace(Law(), **{name: float(p[name]) for name in MODELLED})
