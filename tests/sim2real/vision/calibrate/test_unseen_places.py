"""Places of the real table that no photograph of the calibration showed a puck near to.

The public photographs show the same circles, drawn by hand once, and the warp learns how each was misdrawn. Left out
with all that lies within 6 cm of them, points are found as places are that nobody drew a circle at.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.vision.calibrate.calibration_view import CalibrationView, read_view
from sim2real.vision.calibrate.holdout_view import check_holdout
from sim2real.vision.calibrate.multiview import solve
from sim2real.vision.camera_file import Setup, read_setup
from tests.places import UBC

pytestmark = pytest.mark.slow

CALIBRATION = UBC / "calibration"
NEAR = 0.06  # m
FOLDS = 6


@pytest.fixture(scope="module")
def real() -> tuple[Setup, list[CalibrationView]]:
    if not CALIBRATION.exists():
        pytest.skip(f"no photographs of the real table beside the project ({CALIBRATION})")
    setup = read_setup(CALIBRATION / "camera.json")
    return setup, [read_view(CALIBRATION / f"view_{k}", setup) for k in (1, 2, 3)]


def part(view: CalibrationView, kept: np.ndarray) -> CalibrationView:
    return replace(view, pixels=view.pixels[kept], places=view.places[kept])


def distances(setup: Setup, view: CalibrationView, others: list[CalibrationView]) -> np.ndarray:
    """How far off [m] each point (n,) is found by the others' markers and by their points that are not near it."""
    fold = np.random.default_rng(0).permutation(len(view.places)) % FOLDS
    found = np.zeros(len(fold))
    for one in range(FOLDS):
        out = view.places[fold == one]
        apart = [np.linalg.norm(other.places[:, None] - out, axis=2).min(axis=1) > NEAR for other in others]
        fit = solve(setup, tuple(part(other, kept) for other, kept in zip(others, apart, strict=True)))
        found[fold == one] = check_holdout(setup, fit.geometry, part(view, fold == one)).distances
    return found


@pytest.mark.parametrize("kept", [0, 1, 2])
def test_places_that_nobody_measured_are_found_to_a_millimetre(
    real: tuple[Setup, list[CalibrationView]], kept: int, capsys
):
    setup, views = real
    far = 1e3 * distances(setup, views[kept], [view for k, view in enumerate(views) if k != kept])
    with capsys.disabled():
        print(f"\n{views[kept].name}, places unseen: mean {far.mean():.2f}, max {far.max():.2f} mm")
    assert far.mean() < 0.9 and np.median(far) < 0.75 and far.max() < 4.0
