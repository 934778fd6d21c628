"""The vision before rendered pictures: a table, its renderer, and the calibration that is exactly theirs."""

from __future__ import annotations

import numpy as np

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View
from sim2real.vision.bend import Bend
from sim2real.vision.camera import Camera
from sim2real.vision.locate import Locator
from sim2real.vision.surface import Surface
from sim2real.vision.track.eye import Eye


def camera_of_view(view: View) -> Camera:
    """The intrinsics that a rendered view has."""
    k1, k2, p1, p2, k3 = (float(one) for one in view.distortion)
    (fx, _, cx), (_, fy, cy), _ = view.matrix.tolist()
    return Camera(fx, fy, cx, cy, (k1, k2, p1, p2, k3), view.size)


def exact_locator(table: Table, view: View) -> Locator:
    """The calibration that a rendered view of a flat table has."""
    middle, box = (0.5 * table.length, 0.5 * table.width), ((0.0, 0.0), (table.length, table.width))
    return Locator(camera_of_view(view), np.concatenate([view.rotation, view.shift]), Surface(middle), Bend(box))


def eye_for(renderer: Renderer, locator: Locator, calibration_error: float = 0.0) -> Eye:
    """What looks at this renderer's pictures by a calibration, so far wrong along each axis [m]."""
    table = renderer.table
    return Eye(
        locator, renderer.view.size, length=table.length, width=table.width, puck_radius=table.puck_radius,
        puck_height=table.puck_height, ring_height=table.ring_height, calibration_error=calibration_error,
    )  # fmt: skip
