"""The puck's edge lies where it should: as OpenCV projects its rim, and traced back to the table."""

from __future__ import annotations

import cv2
import numpy as np
import pytest

from sim2real.camera.render.box import Box
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.sensor import Sensor
from sim2real.camera.render.table import Levels, RenderedSurface, Table
from sim2real.camera.render.view import CameraView

DARK = Levels(*(0.0,) * 14)
SHARP = Sensor(blur=0.0, read_noise=0.0, shot_noise=0.0)
WARP = (0.001, 0.002, -0.003, -0.0015, 0.001, 0.002)  # m, a millimetre or two over the table
PLACES = [(0.2, 0.15), (0.61, 0.5), (1.1, 0.93), (1.7, 0.2)]
VIEWS = {
    "real": CameraView.like_the_real_one(2.0, 1.0),
    "side": CameraView.from_place(np.array([0.9, -0.7, 1.1]), np.array([1.0, 0.5, 0.0])),
    "above": CameraView.from_place(np.array([0.99, 0.5, 2.1]), np.array([1.0, 0.5, 0.0])),
}


def only_the_puck(
    view: CameraView, motion: BodyState, warp=(0.0,) * 6, sensor: Sensor = SHARP
) -> tuple[np.ndarray, Box]:
    """Share of each pixel that is puck, in a box round it."""
    levels = Levels(**{**DARK.__dict__, "puck": 100.0})
    renderer = Renderer(Table(surface=RenderedSurface(warp), levels=levels), view, sensor)
    state = SceneState(puck=motion)
    box = renderer.box_of(state)
    brightness = view.brightness_at(np.array([motion.x, motion.y, RenderedSurface(warp).height(*motion[:2]) + 0.00585]))
    return renderer.light(state, box) / (100.0 * brightness), box


def rim(motion: BodyState, warp, count: int = 3000) -> np.ndarray:
    """Points of the puck's rim: on the plane tangent to the surface, shifted up."""
    a0, a1, a2, a3, a4, a5 = warp
    x, y = motion[:2]
    angle = 2.0 * np.pi * np.arange(count) / count
    dx, dy = 0.0309 * np.cos(angle), 0.0309 * np.sin(angle)
    middle = a0 + a1 * x + a2 * y + a3 * x * x + a4 * x * y + a5 * y * y + 0.00585
    return np.stack([x + dx, y + dy, middle + (a1 + 2 * a3 * x + a4 * y) * dx + (a2 + a4 * x + 2 * a5 * y) * dy], 1)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", VIEWS)
def test_coverage_is_that_of_the_rim_as_opencv_projects_it(name: str, place: tuple[float, float]) -> None:
    view, motion = VIEWS[name], BodyState(*place)
    shares, box = only_the_puck(view, motion, WARP)
    points = rim(motion, WARP)
    outline = cv2.projectPoints(points, view.rotation, view.shift, view.matrix, view.distortion)[0][:, 0]
    expected = by_lines(outline, box)
    assert np.abs(shares - expected).max() < 5e-3
    assert shares.sum() == pytest.approx(expected.sum(), rel=2e-5)
    for axis in (0, 1):
        number = np.arange(shares.shape[1 - axis])
        middle, right = (s.sum(axis=axis) @ number / s.sum() for s in (shares, expected))
        assert middle == pytest.approx(right, abs=3e-4)  # pixels


def by_lines(outline: np.ndarray, box: Box, lines: int = 128) -> np.ndarray:
    """Coverage by a convex outline, from where many lines along each row of pixels enter and leave it."""
    rows, columns = box.shape
    v = (np.arange(rows * lines) + 0.5) / lines - 0.5 + box.top
    turned = np.roll(outline, -int(outline[:, 1].argmin()), axis=0)
    turned = np.concatenate([turned, turned[:1]])
    low = int(turned[:, 1].argmax())
    chains = turned[: low + 1], turned[low:][::-1]
    ends = np.sort([np.interp(v, chain[:, 1], chain[:, 0], left=np.nan, right=np.nan) for chain in chains], axis=0)
    left = np.arange(columns)[None] - 0.5 + box.left
    inside = np.clip(np.nan_to_num(ends)[..., None] - left, 0.0, 1.0)
    return (inside[1] - inside[0]).reshape(rows, lines, columns).mean(axis=1)


@pytest.mark.parametrize("place", PLACES)
@pytest.mark.parametrize("name", VIEWS)
def test_traced_back_to_the_table_centre_and_radius_are_right_to_10_micrometres(name, place) -> None:
    """Each pixel's covered area, moved along its ray to the plane of the puck's top, adds up to the puck's disc."""
    view = VIEWS[name]
    shares, box = only_the_puck(view, BodyState(*place))
    v, u = np.mgrid[box.top : box.bottom, box.left : box.right].astype(float)
    corners = [on_plane(view, u + du, v + dv) for du, dv in ((-0.5, -0.5), (0.5, -0.5), (0.5, 0.5), (-0.5, 0.5))]
    diagonals = corners[2] - corners[0], corners[3] - corners[1]
    area = 0.5 * np.abs(diagonals[0][..., 0] * diagonals[1][..., 1] - diagonals[0][..., 1] * diagonals[1][..., 0])
    weight = shares * area
    centre = (weight[..., None] * on_plane(view, u, v)).sum(axis=(0, 1)) / weight.sum()
    assert np.abs(centre - place).max() < 1e-5
    assert np.sqrt(weight.sum() / np.pi) == pytest.approx(0.0309, abs=2e-6)


def on_plane(view: CameraView, u: np.ndarray, v: np.ndarray, z: float = 0.00585) -> np.ndarray:
    """Where the rays of pixels meet the plane z: x and y (..., 2)."""
    k1, k2, p1, p2, k3 = view.distortion
    (fx, _, cx), (_, fy, cy), _ = view.matrix
    bent_x, bent_y = (u - cx) / fx, (v - cy) / fy
    x, y = bent_x, bent_y
    for _ in range(60):  # the lens undone, step by step
        r2 = x * x + y * y
        radial = 1.0 + k1 * r2 + k2 * r2**2 + k3 * r2**3
        shift_x, shift_y = 2 * p1 * x * y + p2 * (r2 + 2 * x * x), p1 * (r2 + 2 * y * y) + 2 * p2 * x * y
        x, y = (bent_x - shift_x) / radial, (bent_y - shift_y) / radial
    turn = cv2.Rodrigues(view.rotation)[0]
    start = -turn.T @ view.shift
    along = np.stack([x, y, np.ones_like(x)], axis=-1) @ turn
    return (start + along * ((z - start[2]) / along[..., 2])[..., None])[..., :2]


def test_a_fast_puck_is_a_streak_around_its_middle() -> None:
    view, exposure, speed = VIEWS["above"], 2e-3, 5.0
    sensor = Sensor(exposure=exposure, blur=0.0)
    still, box = only_the_puck(view, BodyState(1.0, 0.5))
    fast, _ = only_the_puck(view, BodyState(1.0, 0.5, vx=speed), sensor=sensor)
    rows = np.arange(box.shape[0])
    middles, spreads = [], []
    for shares in (still, fast):
        profile = shares.sum(axis=1) / shares.sum()
        middles.append(profile @ rows)
        spreads.append(profile @ (rows - middles[-1]) ** 2)
    pixels = view.project(np.array([(1.0, 0.5, 0.00585), (1.0 + speed * exposure, 0.5, 0.00585)]))
    length = np.linalg.norm(pixels[1] - pixels[0])
    assert length > 5.0
    assert middles[1] == pytest.approx(middles[0], abs=0.02)
    assert spreads[1] - spreads[0] == pytest.approx(length**2 / 12, rel=0.01)
    assert fast.sum() == pytest.approx(still.sum(), rel=1e-3)
