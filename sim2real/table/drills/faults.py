"""What can go wrong at a twin, whatever its camera: a row each. `picture_faults.py` has what only pictures show."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from sim2real.table.faults import Cause
from sim2real.table.twin.twin import Twin

HANG = 0.3  # s
DAMAGED = 0.02  # of the bytes on the line
LATE = 0.08  # s
UNPLUGGED = 0.05  # s from the first moment of what the board notices by itself until the mallet stands
UNSEEN = 0.07  # s of what only the camera's frames tell, which come 120 times a second


@dataclass(frozen=True)
class Fault:
    """A fault by name. begin, end: let it happen to a twin, and mend it; causes: by which it may be noticed, none if
    play goes on; rest_within: s from its first moment until the mallet has to stand, none where nobody can know it yet
    then."""

    name: str
    words: str
    begin: Callable[[Twin], None]
    end: Callable[[Twin], None]
    causes: frozenset[Cause]
    rest_within: float | None = None


def _unplug(twin: Twin) -> None:
    twin.camera.unplugged = True


def _plug(twin: Twin) -> None:
    twin.camera.unplugged = False


def _delay(twin: Twin) -> None:
    twin.camera.late = LATE


def _hurry(twin: Twin) -> None:
    twin.camera.late = 0.0


def _take_puck(twin: Twin) -> None:
    twin.plant.put_puck(np.full(4, math.nan))


def _lay_puck(twin: Twin) -> None:
    twin.plant.put_puck(np.array([0.5 * float(twin.p["length"]), 0.5 * float(twin.p["width"]), 0.0, 0.0]))


def _jam(twin: Twin) -> None:
    twin.plant.jam(True)


def _free(twin: Twin) -> None:
    twin.plant.jam(False)


def _cut(twin: Twin) -> None:
    if twin.board is not None:
        twin.board.cut = True


def _join(twin: Twin) -> None:
    if twin.board is not None:
        twin.board.cut = False


def _damage(twin: Twin) -> None:
    if twin.board is not None:
        twin.board.damage = DAMAGED


def _heal(twin: Twin) -> None:
    if twin.board is not None:
        twin.board.damage = 0.0


def _reset(twin: Twin) -> None:
    if twin.board is not None:
        twin.board.machine.reset("watchdog")


def _hang(twin: Twin) -> None:
    twin.pass_time(twin.now() + HANG)


def _hold(twin: Twin) -> None:
    twin.plant.hold(True)


def _release(twin: Twin) -> None:
    twin.plant.hold(False)


def _nothing(twin: Twin) -> None:
    """It mends itself."""


FAULTS = (
    Fault("camera", "the camera is unplugged", _unplug, _plug, frozenset({Cause.CAMERA_SILENT}), UNSEEN),
    Fault("late-frames", f"frames come {1e3 * LATE:.0f} ms later", _delay, _hurry,
          frozenset({Cause.CAMERA_SILENT, Cause.CAMERA_LATE}), UNSEEN),
    Fault("no-puck", "the puck is taken away", _take_puck, _lay_puck, frozenset({Cause.PUCK_LOST})),
    Fault("jammed", "the puck is jammed where it is", _jam, _free, frozenset()),
    Fault("cable", "the serial cable is cut", _cut, _join,
          frozenset({Cause.PORT_LOST, Cause.BOARD_STOPPED}), UNPLUGGED),
    Fault("noise", f"{100 * DAMAGED:.0f} % of the bytes are damaged", _damage, _heal,
          frozenset({Cause.PLAN_REFUSED, Cause.BOARD_STOPPED, Cause.BOARD_SILENT})),
    Fault("reset", "the board is reset", _reset, _nothing,
          frozenset({Cause.BOARD_NOT_ARMED, Cause.BOARD_SILENT}), UNPLUGGED),
    Fault("hang", f"the policy hangs for {1e3 * HANG:.0f} ms", _hang, _nothing,
          frozenset({Cause.OVERRUN}), UNPLUGGED),
    Fault("held", "the mallet is held fast", _hold, _release, frozenset({Cause.BOARD_STOPPED})),
)  # fmt: skip
