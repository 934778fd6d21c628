"""What hides what, against rays that are followed down to the first solid they enter."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.sensor import Sensor
from sim2real.camera.render.table import LOW_RING, STANDARD_RING, Levels, Table
from sim2real.camera.render.view import CameraView

pytestmark = pytest.mark.slow

NAMES = ("floor", "table", "wall", "rail", "puck", "ring", "opponent", "mallet", "beam", "carriage")
LEVELS = Levels(**{name: 10.0**k for k, name in enumerate(NAMES)}, line=10.0, streak=10.0)
STEP = 0.0002  # m of height
VIEWS = {
    "real": CameraView.like_the_real_one(2.0, 1.0),
    "side": CameraView.from_place(np.array([0.9, -0.7, 1.1]), np.array([1.0, 0.5, 0.0])),
    "above": CameraView.from_place(np.array([0.7, 0.5, 2.1]), np.array([1.0, 0.5, 0.0])),
}
SCENES = {
    "apart": SceneState(puck=BodyState(0.8, 0.3), opponent=BodyState(1.6, 0.6), mallet=BodyState(0.3, 0.5)),
    "puck before opponent": SceneState(puck=BodyState(1.5, 0.55), opponent=BodyState(1.575, 0.58)),
    "puck behind opponent": SceneState(puck=BodyState(1.66, 0.66), opponent=BodyState(1.6, 0.6)),
    "puck before mallet": SceneState(puck=BodyState(0.24, 0.55), mallet=BodyState(0.315, 0.52)),
    "puck behind mallet": SceneState(puck=BodyState(0.42, 0.55), mallet=BodyState(0.34, 0.55)),
    "puck under beam": SceneState(puck=BodyState(0.42, 0.75), mallet=BodyState(0.36, 0.3)),
    "all near the robot's wall": SceneState(
        puck=BodyState(0.031, 0.4), opponent=BodyState(0.16, 0.8), mallet=BodyState(0.0505, 0.5)
    ),
    "all near the right wall": SceneState(
        puck=BodyState(1.0, 0.031), opponent=BodyState(1.3, 0.0505), mallet=BodyState(0.6, 0.06)
    ),
    "all near the far wall": SceneState(
        puck=BodyState(1.969, 0.4), opponent=BodyState(1.949, 0.6), mallet=BodyState(0.9, 0.06)
    ),
}


def solids(table: Table, state: SceneState):
    """Who is at x, y, z: a name and a predicate each. The puck's side is not drawn, so that it is a thin disc here."""

    def near(body: BodyState | None, radius):
        return lambda x, y: np.hypot(x - body.x, y - body.y) <= radius if body else np.zeros(x.shape, bool)

    def at(z, height):
        return (z <= height) & (z > height - 1.001 * STEP)

    cone = table.mallet_radius, table.ring_radius - table.mallet_radius
    ring = table.ring_height
    outer, inner = near(state.opponent, table.ring_radius), near(state.opponent, table.ring_hole)
    yield "ring", lambda x, y, z: at(z, ring) & outer(x, y) & ~inner(x, y)
    yield "opponent", lambda x, y, z: (z <= ring) & near(state.opponent, cone[0] + cone[1] * z / ring)(x, y)
    yield "mallet", lambda x, y, z: (z <= table.mallet_height) & near(state.mallet, table.mallet_radius)(x, y)
    yield "puck", lambda x, y, z: at(z, table.puck_height) & near(state.puck, table.puck_radius)(x, y)
    if state.mallet:
        mx, my = state.mallet[:2]
        low, high = table.beam_heights
        yield (
            "carriage",
            lambda x, y, z: (
                (((z >= 0.06) & (z <= low)) | ((z >= high) & (z <= high + 0.015)))
                & (abs(x - mx) <= 0.04)
                & (abs(y - my) <= 0.045)
            ),
        )
        yield (
            "beam",
            lambda x, y, z: (z >= low) & (z <= high) & (abs(x - mx) <= 0.02) & (y >= -0.12) & (y <= table.width + 0.12),
        )

    def beyond(x, y):
        return np.maximum.reduce([-x, -y, x - table.length, y - table.width])

    height, wide = table.wall_height, table.rail_width
    yield "rail", lambda x, y, z: at(z, height) & (beyond(x, y) > 0) & (beyond(x, y) <= wide)
    yield "wall", lambda x, y, z: (z <= height) & (beyond(x, y) > 0) & (beyond(x, y) <= wide)
    yield "table", lambda x, y, z: at(z, 0.0) & (beyond(x, y) <= 0)


def first_met(view: CameraView, table: Table, state: SceneState, pixels: np.ndarray) -> np.ndarray:
    """Index in NAMES of what each pixel (n, 2) sees first; rays are followed from above everything to the table."""
    rays = cv2.undistortPoints(pixels[:, None], view.matrix, view.distortion)[:, 0]
    turn = cv2.Rodrigues(view.rotation)[0]
    along = np.column_stack([rays, np.ones(len(rays))]) @ turn
    start = -turn.T @ view.shift
    met = np.full(len(pixels), NAMES.index("floor"))
    left = np.ones(len(pixels), bool)
    for z in np.arange(0.13, -STEP, -STEP):
        x, y, _ = (start + along * ((z - start[2]) / along[:, 2])[:, None]).T
        for name, inside in solids(table, state):
            hit = left & inside(x, y, z)
            met[hit] = NAMES.index(name)
            left &= ~hit
    return met


@pytest.mark.parametrize("height", [STANDARD_RING, LOW_RING])
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("name", VIEWS)
def test_each_pixel_shows_what_its_ray_meets_first(name: str, scene: str, height: float) -> None:
    """Pixels on a border, where the levels of 3 x 3 neighbours differ, are left out: there they are mixed."""
    view, state = VIEWS[name], SCENES[scene]
    table = Table(levels=LEVELS, ring_height=height)
    light = Renderer(table, view, Sensor(blur=0.0)).light(state)
    shown = np.rint(np.log10(light))  # the lamp's distance makes it brighter or darker by less than half a decade
    same = cv2.dilate(light, np.ones((3, 3))) < 1.02 * cv2.erode(light, np.ones((3, 3)))
    random = np.random.default_rng(1)
    boxes = [np.clip(view.project(np.array([(m.x, m.y, 0.05)]))[0], 0, 1e4) for m in state.bodies]
    pixels = np.concatenate([middle + random.uniform(-90, 90, (400, 2)) for middle in boxes]).round()
    inside = (pixels >= 2).all(axis=1) & (pixels < np.array(view.size) - 2).all(axis=1)
    pixels = pixels[inside]
    columns, rows = pixels.astype(int).T
    met = first_met(view, table, state, pixels)
    kept = same[rows, columns] & (met != NAMES.index("floor"))
    assert kept.sum() > 200
    wrong = shown[rows, columns][kept] != met[kept]
    pairs = zip(shown[rows, columns][kept][wrong], met[kept][wrong], strict=True)
    assert not wrong.any(), {(NAMES[int(seen)], NAMES[expected]) for seen, expected in pairs}
