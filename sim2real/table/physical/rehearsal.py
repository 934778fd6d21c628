"""A rehearsal in real time without a table: rendered pictures come at the camera's rate, and the emulated board, in a
process of its own, answers at a pseudo-terminal."""

from __future__ import annotations

import math
import multiprocessing
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from itertools import islice
from multiprocessing.connection import Connection

import numpy as np

from sim2real.camera.frame import Frame
from sim2real.camera.live.live_source import Live
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.scene_states import simulated_states
from sim2real.garbage import collect_and_freeze
from sim2real.link.serial_port import SerialPort
from sim2real.table.backend import Place
from sim2real.table.board_config import board_config
from sim2real.table.game.game_record import GameRecord
from sim2real.table.physical.eyes import LiveEyes
from sim2real.table.physical.frame_reader import FrameReader
from sim2real.table.physical.real_time import RealTimeTable
from sim2real.table.twin.rendered_table import RenderedTable
from sim2real.vision.track.kalman_tracker import FASTEST

RATE, DELAY = 120.0, 0.0  # Hz; s from exposure to arrival
PATIENCE = 2.0  # s: nobody looks for a puck that is not seen
PLAYERS = ("interceptor", "follower")


class PacedPictures(Live):
    """Pictures that were rendered beforehand, forward and back and so on, at RATE by the clock: nothing is ever
    suddenly elsewhere, as at a table."""

    def __init__(self, pictures: list[np.ndarray]) -> None:
        super().__init__()
        self._pictures, self._count, self._begin = [*pictures, *pictures[-2:0:-1]], 0, 0.0

    def _open(self) -> None:
        self._begin = time.perf_counter()

    def _grab(self) -> Frame | None:
        self._count += 1
        due = self._begin + self._count / RATE
        time.sleep(max(due - time.perf_counter(), 0.0))
        picture = self._pictures[self._count % len(self._pictures)]
        return Frame(picture, due, time.perf_counter(), self._count)

    def _close(self) -> None:
        """Nothing is held open."""


class Nobody:
    """Nobody at the other end: puck and mallets of the pictures move by themselves."""

    def put_puck(self, puck: np.ndarray) -> None:
        """The puck is where the pictures have it."""

    def home_mallet(self, home: Place) -> None:
        """The emulated mallet is at home."""

    def play(self, game: np.void) -> None:
        """The pictures go on."""


@contextmanager
def rehearsal_table(game: GameRecord, home: Place, frames: int) -> Iterator[RealTimeTable]:
    """A table in real time, whose camera shows one rally again and again, at most so many frames. ValueError, in one
    line, where the emulator is not installed."""
    rendered = RenderedTable.of(game.p)
    renderer = Renderer(rendered.table, rendered.view)
    states = simulated_states(game.tables.variant.id, PLAYERS, 0, RATE)
    pictures = [renderer.picture(state, number) for number, state in enumerate(islice(_rally(states), frames))]
    reader = FrameReader(rendered.calibration(), rendered.targets())
    with emulated_board(home) as port:
        table = RealTimeTable(
            board_config(game.p),
            RATE,
            lambda: SerialPort(port, wait=0.0),
            lambda: LiveEyes(PacedPictures(pictures), reader, DELAY),
            lambda serve: Nobody(),
        )
        table.patience = PATIENCE
        yield table


def _rally(states: Iterator[SceneState]) -> Iterator[SceneState]:
    """The states until the puck is in a goal, or put elsewhere after one."""
    last = None
    for state in states:
        puck = state.puck
        if puck is None or (last is not None and math.hypot(puck.x - last.x, puck.y - last.y) > FASTEST / RATE):
            return
        yield state
        last = puck


@contextmanager
def emulated_board(place: Place) -> Iterator[str]:
    """The port of a board that is emulated in another process, its mallet at rest at `place` [m]."""
    context = multiprocessing.get_context("spawn")
    here, there = context.Pipe()
    process = context.Process(target=_serve_board, args=(there, place), daemon=True)
    process.start()
    there.close()  # so that the end of the other process ends what is received
    try:
        try:
            port = here.recv()
        except EOFError:
            raise ValueError("the emulated board ended at once; run puckpilot firmware emulate to see why") from None
        if isinstance(port, Exception):
            raise ValueError(f"the board cannot be emulated here: {port}") from None
        yield port
    finally:
        with suppress(OSError):  # it may have ended
            here.send("end")
        process.join(5.0)
        process.kill()


def _serve_board(parent: Connection, place: Place) -> None:
    """In the other process: emulate the board until the parent says something, or is gone. It tells its port, or why
    there is none."""
    try:
        from firmware import ELF
        from sim2real.emulate.gantry import Gantry
        from sim2real.emulate.machine import Machine
        from sim2real.emulate.pseudo_terminal import serve, terminal

        machine = Machine(ELF, seed=1)
        Gantry(machine, place=place)
    except (ImportError, OSError, ValueError) as error:
        parent.send(error)
        return
    collect_and_freeze()
    with terminal() as (descriptor, name):
        parent.send(name)
        serve(machine, descriptor, lambda seconds: not parent.poll())
