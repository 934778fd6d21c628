"""From pixels to the table against the way forth by cv2.projectPoints; the closed form against the grid."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2real.vision.coordinate_warp import TERMS, CoordinateWarp
from sim2real.vision.locate import Locator, PlaceGrid
from sim2real.vision.surface import Surface
from tests.sim2real.vision import world
from tests.sim2real.vision.test_camera import CAMERA

MIDDLE = (world.LENGTH / 2, world.WIDTH / 2)
BOX = ((0.05, 0.05), (1.95, 0.95))
MOTION = world.camera_motion(world.CAMERA_PLACES[1])
LOCATOR = Locator(CAMERA, MOTION, Surface(MIDDLE, world.CURVATURE), CoordinateWarp(BOX))


def test_pixels_of_known_places_are_found_there():
    pixels = world.seen(MOTION, world.puck_points(world.grid()))
    np.testing.assert_allclose(LOCATOR.places(pixels, world.TOP), world.grid(), atol=1e-9)
    np.testing.assert_allclose(LOCATOR.pixels(world.grid(), world.TOP), pixels, atol=1e-6)


def test_height_matters():
    """A mark 4 cm above the table is found beside its place by what similar triangles say."""
    origin, place = np.array(world.CAMERA_PLACES[0]), np.array([[1.0, 0.5, 0.04]])
    locator = Locator(CAMERA, world.camera_motion(world.CAMERA_PLACES[0]), Surface(MIDDLE), CoordinateWarp(BOX))
    found = locator.places(world.seen(locator.motion, place), 0.0)[0]
    np.testing.assert_allclose(
        found, origin[:2] + (place[0, :2] - origin[:2]) * origin[2] / (origin[2] - 0.04), atol=1e-9
    )


@given(
    st.floats(-0.05, 0.05), st.floats(-0.05, 0.05), st.floats(-0.05, 0.05),
    st.floats(0.0, 2.0), st.floats(0.0, 1.0), st.floats(0.0, 0.1),
)  # fmt: skip
def test_rays_meet_any_surface(xx: float, xy: float, yy: float, x: float, y: float, height: float):
    """A point that is put on the surface is where the ray to it ends."""
    dx, dy = x - MIDDLE[0], y - MIDDLE[1]
    point = np.array([x, y, xx * dx * dx + xy * dx * dy + yy * dy * dy + height])
    origin = np.array(world.CAMERA_PLACES[2])
    found = Surface(MIDDLE, (xx, xy, yy)).meet(origin, 3.0 * (point - origin)[None], height)
    np.testing.assert_allclose(found[0], point, atol=1e-9)


def test_rays_that_lead_away_meet_nothing():
    found = Surface(MIDDLE).meet(np.array([0.0, 0.0, 1.0]), np.array([[1.0, 0.0, 0.1], [1.0, 0.0, 0.0]]), 0.0)
    assert np.isnan(found).all()


def test_the_bend_is_undone():
    warp = CoordinateWarp(BOX, np.random.default_rng(3).normal(0.0, 1e-3, len(TERMS)))
    places = world.grid()
    assert 5e-4 < np.abs(warp.rigid(places) - places).max() < 0.02
    np.testing.assert_allclose(warp.measured(warp.rigid(places)), places, atol=1e-8)


def test_beyond_what_was_measured_the_bend_is_what_it_is_at_the_border():
    warp = CoordinateWarp(BOX, np.random.default_rng(4).normal(0.0, 1e-3, len(TERMS)))
    inside, outside = np.array([[1.95, 0.5]]), np.array([[2.3, 0.5]])
    np.testing.assert_allclose(outside - warp.rigid(outside), inside - warp.rigid(inside), atol=1e-12)


def test_a_first_order_polynomial_is_what_it_says():
    """y too large by 1 mm at the left end of the box, too small by 1 mm at its right end."""
    warp = np.zeros(len(TERMS))
    warp[TERMS.index((1, 0, 1))] = 1e-3
    off = CoordinateWarp(BOX, warp).rigid(np.array([[1.0, 0.95], [1.0, 0.5], [1.0, 0.05]])) - [
        [1.0, 0.95],
        [1.0, 0.5],
        [1.0, 0.05],
    ]
    np.testing.assert_allclose(off, [[0.0, -1e-3], [0.0, 0.0], [0.0, 1e-3]], atol=1e-15)


def test_the_grid_is_the_closed_form():
    """Bilinear between nodes of 8 pixels: 0.1 mm off at most, at the far end where a pixel is largest."""
    grid = PlaceGrid(LOCATOR, world.TOP, world.SIZE)
    places = np.random.default_rng(5).uniform((0.0, 0.0), (world.LENGTH, world.WIDTH), (3000, 2))
    pixels = LOCATOR.pixels(places, world.TOP)
    pixels = pixels[(pixels >= 0.0).all(axis=1) & (pixels <= np.array(world.SIZE) - 1).all(axis=1)]
    off = np.hypot(*(grid.places(pixels) - LOCATOR.places(pixels, world.TOP)).T)
    assert len(pixels) > 2500 and off.max() < 1e-4 and np.median(off) < 3e-5
    nodes = np.floor(pixels / 8) * 8
    np.testing.assert_allclose(grid.places(nodes), LOCATOR.places(nodes, world.TOP), atol=1e-12)


@pytest.mark.parametrize("pixel", [(-1.0, 5.0), (5.0, 5000.0), (np.nan, 5.0)])
def test_the_grid_ends_with_the_picture(pixel: tuple[float, float]):
    assert np.isnan(PlaceGrid(LOCATOR, world.TOP, world.SIZE).places(np.array([pixel]))).all()
