"""What calibrations of a rendered table err by, as Legendre polynomials over the table in units of what they state.

python -m tests.sim2real.vision.trial.fields [CALIBRATIONS] [RULER in m]
"""

from __future__ import annotations

import sys

import numpy as np
from numpy.polynomial.legendre import legvander2d

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.calibrate.pose import camera_pose
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.locate import Locator
from sim2real.vision.markers import find_markers
from sim2real.vision.trial import rendered_calibration

ORDER, GRID, INSET = 6, (25, 13), 0.04  # of polynomials; places along and across; m from the walls


def errors_of(seed: int) -> tuple[np.ndarray, np.ndarray]:
    """One calibration's coefficients (ORDER + 1, ORDER + 1, 2) by the orders in x and y, of the errors of x and y in
    units of the stated deviation; and those of places (n, 2), likewise."""
    rendered = Table.with_markers()
    view = CameraView.like_the_real_one(rendered.length, rendered.width)
    table = TableCalibration.of(*rendered_calibration.estimated_calibration(rendered, view, seed))
    camera = table.setup.camera
    corners = find_markers(Renderer(rendered, view, seed=seed).picture(SceneState()), camera, table.setup.dictionary)
    pose = camera_pose(table.setup, table.geometry, corners)
    locator = Locator(camera, pose.motion, table.geometry.surface, table.geometry.warp)
    axes = [
        np.linspace(INSET, side - INSET, many)
        for side, many in zip((rendered.length, rendered.width), GRID, strict=True)
    ]
    places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=2).reshape(-1, 2)
    pixels = view.project(rendered.surface.on(places, rendered.puck_height))
    off = (locator.places(pixels, table.setup.puck_top) - places) / table.place_std
    x, y = (2.0 * places / (rendered.length, rendered.width) - 1.0).T
    few = np.add.outer(np.arange(ORDER + 1), np.arange(ORDER + 1)) <= ORDER
    columns = legvander2d(x, y, [ORDER, ORDER])[:, few.ravel()]
    found = np.zeros((ORDER + 1, ORDER + 1, 2))
    found[few] = np.linalg.lstsq(columns, off, rcond=None)[0]
    return found, off


if __name__ == "__main__":
    many = int(sys.argv[1]) if len(sys.argv) > 1 else 12
    if len(sys.argv) > 2:
        rendered_calibration.RULER = float(sys.argv[2])
    every = [errors_of(seed) for seed in range(many)]
    print(f"places are off by {np.sqrt(np.mean([off**2 for _, off in every])):.2f} times what is stated")
    sizes = np.sqrt(np.mean([one**2 for one, _ in every], axis=0))
    for order in range(ORDER + 1):
        for i in range(order, -1, -1):
            x, y = sizes[i, order - i]
            print(f"order {i} in x, {order - i} in y: {x:.3f} of x's error, {y:.3f} of y's")
