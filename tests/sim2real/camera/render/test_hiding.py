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
    """Who is at x, y, z: a name, a range of z and a predicate each. The puck's side is not drawn, so that it is a thin
    disc here."""

    def near(body: BodyState, radius):
        return lambda x, y, z: (x - body.x) ** 2 + (y - body.y) ** 2 <= radius(z) ** 2

    def at(height):
        return height - 1.001 * STEP, height

    if state.opponent:
        outer, inner = (near(state.opponent, lambda _, r=r: r) for r in (table.ring_radius, table.ring_hole))
        yield "ring", at(table.ring_height), lambda x, y, z: outer(x, y, z) & ~inner(x, y, z)
        wider = (table.ring_radius - table.mallet_radius) / table.ring_height
        cone = near(state.opponent, lambda z: table.mallet_radius + wider * z)
        yield "opponent", (-np.inf, table.ring_height), cone
    if state.mallet:
        yield "mallet", (-np.inf, table.mallet_height), near(state.mallet, lambda _: table.mallet_radius)
    if state.puck:
        yield "puck", at(table.puck_height), near(state.puck, lambda _: table.puck_radius)
    if state.mallet:
        mx, my = state.mallet[:2]
        low, high = table.beam_heights
        for plate in ((0.06, low), (high, high + 0.015)):
            yield "carriage", plate, lambda x, y, _: (abs(x - mx) <= 0.04) & (abs(y - my) <= 0.045)
        along = -0.12, table.width + 0.12
        yield "beam", (low, high), lambda x, y, _: (abs(x - mx) <= 0.02) & (y >= along[0]) & (y <= along[1])

    def beyond(x, y):
        return np.maximum.reduce([-x, -y, x - table.length, y - table.width])

    height, wide = table.wall_height, table.rail_width
    yield "rail", at(height), lambda x, y, _: (beyond(x, y) > 0) & (beyond(x, y) <= wide)
    yield "wall", (-np.inf, height), lambda x, y, _: (beyond(x, y) > 0) & (beyond(x, y) <= wide)
    yield "table", at(0.0), lambda x, y, _: beyond(x, y) <= 0


def first_met(view: CameraView, table: Table, state: SceneState, pixels: np.ndarray) -> np.ndarray:
    """Index in NAMES of what each pixel (n, 2) sees first; rays are followed from above everything to the table."""
    rays = cv2.undistortPoints(pixels[:, None], view.matrix, view.distortion)[:, 0]
    turn = cv2.Rodrigues(view.rotation)[0]
    along = np.column_stack([rays, np.ones(len(rays))]) @ turn
    start = -turn.T @ view.shift
    met = np.full(len(pixels), NAMES.index("floor"))
    left = np.arange(len(pixels))
    ranges = list(solids(table, state))
    for z in np.arange(0.13, -STEP, -STEP):
        x, y = (start + along[left] * ((z - start[2]) / along[left, 2])[:, None])[:, :2].T
        for name, (low, high), inside in ranges:
            if low < z <= high:
                hit = inside(x, y, z)
                met[left[hit]] = NAMES.index(name)
                left, x, y = left[~hit], x[~hit], y[~hit]
    return met


@pytest.fixture(
    scope="module",
    params=[(name, height) for name in VIEWS for height in (STANDARD_RING, LOW_RING)],
    ids=lambda one: f"{one[0]}-{one[1]}",
)
def renderer(request: pytest.FixtureRequest) -> Renderer:
    name, height = request.param
    return Renderer(Table(levels=LEVELS, ring_height=height), VIEWS[name], Sensor(blur=0.0))


@pytest.mark.parametrize("scene", SCENES)
def test_each_pixel_shows_what_its_ray_meets_first(renderer: Renderer, scene: str) -> None:
    """Pixels on a border, where the levels of 3 x 3 neighbours differ, are left out: there they are mixed."""
    view, table, state = renderer.view, renderer.table, SCENES[scene]
    light = renderer.light(state)
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
