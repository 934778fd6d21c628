"""The joint fit on a made-up table whose pixels come from cv2.projectPoints: truth, error bars, wrong points."""

from __future__ import annotations

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.holdout_view import check_holdout
from sim2real.vision.calibrate.multiview import MultiviewFit, solve
from sim2real.vision.calibrate.width_check import width_step
from sim2real.vision.camera_file import Setup
from sim2real.vision.table_geometry import MARKERS_START
from tests.sim2real.vision import world
from tests.sim2real.vision.test_camera import CAMERA

SETUP = Setup(CAMERA, "DICT_4X4_50", world.TOP, world.LENGTH, world.WIDTH)
PLACE_NOISE, PIXEL_NOISE, CORNER_NOISE = 0.5e-3, 0.1, 0.03


def view(k: int, noise: float = 1.0) -> CalibrationView:
    """Camera k, its points seen at places that are known to half a millimetre."""
    rng, motion = np.random.default_rng(k), world.camera_motion(world.CAMERA_PLACES[k])

    def shaken(exact: np.ndarray, std: float) -> np.ndarray:
        return exact + noise * rng.normal(0.0, std, exact.shape)

    corners = {name: shaken(world.seen(motion, one), CORNER_NOISE) for name, one in world.markers().items()}
    pixels = shaken(world.seen(motion, world.puck_points(world.grid())), PIXEL_NOISE)
    return CalibrationView(f"view_{k}", corners, pixels, shaken(world.grid(), PLACE_NOISE))


@cache
def fit() -> MultiviewFit:
    return solve(SETUP, (view(0), view(1), view(2)))


def true_vector() -> np.ndarray:
    return np.concatenate([world.CURVATURE, np.zeros(MARKERS_START - 3), *map(np.ravel, world.markers().values())])


def test_without_noise_it_is_exact():
    found = solve(SETUP, tuple(view(k, 0.0) for k in range(3)))
    np.testing.assert_allclose(
        found.poses, [world.camera_motion(place) for place in world.CAMERA_PLACES[:3]], atol=3e-5
    )
    np.testing.assert_allclose(found.geometry.vector(), true_vector(), atol=2e-5)


def test_the_error_bars_hold_the_truth():
    off = fit().geometry.vector() - true_vector()
    z = off / np.sqrt(np.diag(fit().geometry_covariance()))
    assert np.abs(z).max() < 4.0 and 0.1 < np.sqrt((z**2).mean()) < 1.3


def test_an_unused_view_is_found_to_a_third_of_a_millimetre():
    exact = replace(view(3), places=world.grid())
    checked = check_holdout(SETUP, fit().geometry, exact)
    assert 1e3 * checked.distances.mean() < 0.3 and 1e3 * checked.distances.max() < 0.8
    np.testing.assert_allclose(checked.pose.origin, world.CAMERA_PLACES[3], atol=3e-3)


def test_the_check_looks_at_no_measured_point():
    """The pose is of the markers alone: shifted places are found off by just that shift."""
    base = check_holdout(SETUP, fit().geometry, view(3))
    shifted = check_holdout(SETUP, fit().geometry, replace(view(3), places=view(3).places + np.array([0.01, 0.0])))
    np.testing.assert_allclose(base.off - shifted.off, np.tile([0.01, 0.0], (36, 1)), atol=1e-12)


def test_a_wrong_point_is_named_and_does_no_harm():
    mistyped = view(1)
    places = mistyped.places.copy()
    places[20] += (0.0030, -0.0035)
    found = solve(SETUP, (view(0), replace(mistyped, places=places), view(2)))
    assert [np.flatnonzero(one).tolist() for one in found.wrong] == [[], [20], []]
    assert 1e3 * np.hypot(*found.off[1][20]) == pytest.approx(4.6, abs=1.2)
    assert not any(one.any() for one in fit().wrong)
    exact = replace(view(3), places=world.grid())
    assert 1e3 * check_holdout(SETUP, found.geometry, exact).distances.mean() < 0.3


def test_derivatives_are_differences():
    problem, vector = fit().problem, fit().fitted.vector
    whitening = problem.whitening(vector)
    _, by = problem.evaluate(vector, whitening)
    for k in range(len(vector)):
        step = 1e-6 * np.eye(len(vector))[k]
        ahead, behind = (problem.evaluate(vector + one, whitening)[0] for one in (step, -step))
        np.testing.assert_allclose(by[:, k], (ahead - behind) / 2e-6, atol=1e-5 * np.abs(by).max())


@pytest.mark.parametrize("wrong", [0.003, -0.004])
def test_a_width_that_is_stated_wrong_is_measured(wrong: float):
    """Those left of the middle are measured from the left wall of a table that is narrower than stated."""
    views = []
    for k in range(3):
        places = view(k).places.copy()
        places[places[:, 1] > world.WIDTH / 2, 1] += wrong
        views.append(replace(view(k), places=places))
    step = width_step(solve(SETUP, tuple(views)), world.WIDTH)
    assert step is not None and step.clear and abs(step.value - wrong) < 4.0 * step.std < 0.0016


def test_a_width_that_is_right_is_not_doubted():
    step = width_step(fit(), world.WIDTH)
    assert step is not None and not step.clear and abs(step.value) < 4.0 * step.std
    right = world.grid()[:, 1] < world.WIDTH / 2
    half = tuple(replace(one, pixels=one.pixels[right], places=one.places[right]) for one in fit().problem.views)
    assert width_step(solve(SETUP, half), world.WIDTH) is None


@pytest.mark.parametrize(
    "change, words",
    [
        (
            lambda p: p[:, ::-1].copy(),
            r"view_0: the points are mirrored: they fit to \d\.\d mm, but .* under the table",
        ),
        (lambda p: p * [1.0, 0.9], r"view_0: on a flat table the points are \d\d mm from .* expected 10"),
        (lambda p: np.roll(p, 7, axis=0), r"view_0: on a flat table the points are \d+ mm from"),
        (
            lambda p: p + 0.3 * (np.arange(36)[:, None] == 4) * [1.0, 0.0],
            r"view_0: not seen where measured: point 5 \((29|30)\d mm\); the other 35 are, to \d\.\d mm: mend",
        ),
        (
            lambda p: p + 0.3 * np.isin(np.arange(36), (4, 30))[:, None] * [0.0, -1.0],
            r"view_0: not seen where measured: point 5 \(\d\d\d mm\), point 31 \(\d\d\d mm\); the other 34",
        ),
    ],
)
def test_places_that_cannot_be_are_refused(change, words: str):
    with pytest.raises(ValueError, match=words):
        solve(SETUP, (replace(view(0), places=change(view(0).places)), view(1)))


def test_points_on_one_line_are_refused():
    line = replace(view(0), pixels=view(0).pixels[::6], places=view(0).places[::6])
    with pytest.raises(ValueError, match=r"view_0: its points lie on one line, to [01] mm; expected them all over"):
        solve(SETUP, (line, view(1)))


def seen_from(place: tuple[float, float, float], seed: int) -> CalibrationView:
    """Not one of the four cameras', but seen with the same errors."""
    rng, motion = np.random.default_rng(seed), world.camera_motion(place)
    corners = {name: world.seen(motion, one) for name, one in world.markers().items()}
    corners = {name: one + rng.normal(0.0, CORNER_NOISE, (4, 2)) for name, one in corners.items()}
    pixels = world.seen(motion, world.puck_points(world.grid())) + rng.normal(0.0, PIXEL_NOISE, (36, 2))
    return CalibrationView(f"seen {seed}", corners, pixels, world.grid())


@pytest.mark.parametrize("aside", [0.0, 0.005])
def test_views_from_one_place_are_refused(aside: float):
    x, y, z = world.CAMERA_PLACES[0]
    with pytest.raises(
        ValueError, match=r"placed to \d+ mm only; expected 40 at most: two cameras are 0\.0[01] m apart"
    ):
        solve(SETUP, (seen_from((x, y, z), 1), seen_from((x, y + aside, z), 2)))
    assert len(solve(SETUP, (seen_from((x, y, z), 1), seen_from((x, y + 0.2, z), 2))).poses) == 2


def test_a_marker_that_was_moved_between_photographs_is_reported():
    motion = world.camera_motion(world.CAMERA_PLACES[2])
    corners = {**view(2).corners, 3: world.seen(motion, world.markers()[3] + [0.02, 0.0, 0.0])}
    with pytest.raises(ValueError, match=r"view_2: markers are \d\.\d px rms from where the other views have them"):
        solve(SETUP, (view(0), view(1), replace(view(2), corners=corners)))


def test_a_view_that_contradicts_the_others_is_refused():
    off = replace(view(0), places=view(0).places * [1.0, 0.985])
    with pytest.raises(ValueError, match=r"view_0: \d\d of its 36 points contradict the other views, by \d\.\d mm"):
        solve(SETUP, (off, view(1), view(2)))


def test_a_view_of_which_half_contradicts_the_others_is_refused():
    """15 of 36 points by a centimetre, every which way."""
    turn = 2.4 * np.arange(36)
    off = 0.010 * np.stack([np.cos(turn), np.sin(turn)], axis=1) * (np.arange(36)[:, None] % 12 < 5)
    with pytest.raises(ValueError, match=r"view_0: 1[2-8] of its 36 points contradict the other views"):
        solve(SETUP, (replace(view(0), places=view(0).places + off), view(1), view(2)))


@pytest.mark.parametrize("scale, message", [([1.0, 1.02], r"\+(1\.9|2\.0)"), ([1.02, 1.0], r"-(1\.9|2\.0)")])
def test_a_size_that_is_wrong_in_all_views_is_refused(scale: list[float], message: str):
    views = tuple(replace(view(k), places=view(k).places * scale - [0.01, 0.005]) for k in range(3))
    with pytest.raises(ValueError, match=rf"are up to \d+ mm from any rigid table .* y {message} % long against x"):
        solve(SETUP, views)


@pytest.mark.parametrize("height, message", [(0.25, "[34]"), (0.6, "9")])
def test_a_table_seen_edge_on_is_refused(height: float, message: str):
    """The far end is 3.93 m away."""
    motion = world.camera_motion((-2.0, 0.5, height))
    flat = CalibrationView("low", view(0).corners, world.seen(motion, world.puck_points(world.grid())), world.grid())
    with pytest.raises(ValueError, match=rf"low: the table is seen edge-on, its far end from {message} degrees above"):
        solve(SETUP, (flat, view(1)))


def test_too_little_is_refused():
    with pytest.raises(ValueError, match="1 view is given; expected 2"):
        solve(SETUP, (view(0),))
    few = replace(view(1), corners={name: view(1).corners[name] for name in (0, 1)})
    with pytest.raises(ValueError, match="2 markers are seen in two views or more; expected 3"):
        solve(SETUP, (view(0), few))
