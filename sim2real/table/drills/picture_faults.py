"""What can go wrong before the lens of a twin that takes pictures: a row each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.table.backend import Place
from sim2real.table.drills.faults import Fault
from sim2real.table.faults import Cause
from sim2real.table.twin.picture_camera import PictureCamera
from sim2real.table.twin.things import hand, second_puck
from sim2real.table.twin.twin import Twin

DIM, GLARING = 0.3, 12.0  # of the usual brightness
KNOCK = np.array([0.004, 0.0, 0.0])  # m
BESIDE = 0.08  # m from the puck to a second one


def _camera(twin: Twin) -> PictureCamera:
    assert isinstance(twin.camera, PictureCamera)
    return twin.camera


def _light(share: float) -> Callable[[Twin], None]:
    def change(twin: Twin) -> None:
        _camera(twin).scene.light = share

    return change


def _place_of_puck(twin: Twin) -> Place:
    """Where the puck is [m]; the middle of the table if it is in a goal."""
    x, y = float(twin.plant.puck[0]), float(twin.plant.puck[1])
    return (x, y) if np.isfinite(x) else (0.5 * float(twin.p["length"]), 0.5 * float(twin.p["width"]))


def _take_in_hand(twin: Twin) -> None:
    _camera(twin).scene.things = (hand(_place_of_puck(twin)),)
    twin.plant.put_puck(np.full(4, np.nan))


def _let_go(twin: Twin) -> None:
    _take_away(twin)
    twin.plant.put_puck(np.array([*_place_of_puck(twin), 0.0, 0.0]))


def _lay_second(twin: Twin) -> None:
    x, y = _place_of_puck(twin)
    inwards = np.sign(0.5 * float(twin.p["width"]) - y) or 1.0
    twin.plant.put_puck(np.array([x, y, 0.0, 0.0]))
    _camera(twin).scene.things = (second_puck((x, y + inwards * BESIDE), _camera(twin).rendered),)


def _take_away(twin: Twin) -> None:
    _camera(twin).scene.things = ()


def _knock_camera(twin: Twin) -> None:
    rendered = _camera(twin).rendered
    _camera(twin).renderer = Renderer(rendered.table, replace(rendered.view, shift=rendered.view.shift + KNOCK))


def _knock_marker(twin: Twin) -> None:
    rendered = _camera(twin).rendered
    *others, last = rendered.table.markers  # the gantry never hides the last one
    moved = replace(last, corners=last.corners + KNOCK)
    _camera(twin).renderer = Renderer(replace(rendered.table, markers=(*others, moved)), rendered.view)


def _put_back(twin: Twin) -> None:
    rendered = _camera(twin).rendered
    _camera(twin).renderer = Renderer(rendered.table, rendered.view)


LOST, TROUBLE = frozenset({Cause.PUCK_LOST}), frozenset({Cause.CAMERA_TROUBLE})
PICTURE_FAULTS = (
    Fault("dark", f"the lamp fades to {100 * DIM:.0f} %", _light(DIM), _light(1.0), LOST | TROUBLE),
    Fault("glare", f"the lamp is {GLARING:g} times as bright", _light(GLARING), _light(1.0), LOST | TROUBLE),
    Fault("hand", "a hand holds the puck", _take_in_hand, _let_go, LOST),
    Fault("second-puck", "a second puck lies beside the first", _lay_second, _take_away,
          frozenset({Cause.SEVERAL_PUCKS})),
    Fault("camera-knocked", f"the camera moves by {1e3 * KNOCK[0]:.0f} mm", _knock_camera, _put_back, TROUBLE),
    Fault("marker-knocked", f"a marker moves by {1e3 * KNOCK[0]:.0f} mm", _knock_marker, _put_back, TROUBLE),
)  # fmt: skip
