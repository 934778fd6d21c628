"""Two frames of play on the real table: a region of interest of the sensor, raw mosaic, exposed for 100 us.

They lie beside the project. Noise of up to two grey levels is drawn by pictures, as `python -m
tests.sim2real.vision.track.regions.test_real_frames 100` does a hundred times.
"""

from __future__ import annotations

import sys
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.ndimage import map_coordinates

import puckpilot
from sim2real.camera.frame import Frame
from sim2real.camera.grey_image import read_grey
from sim2real.camera.region import RegionOfInterest
from sim2real.camera.settings import CameraSettings
from sim2real.vision.calibrate.calibration_view import read_view
from sim2real.vision.calibrate.find_camera import find_camera
from sim2real.vision.calibrate.multiview import solve
from sim2real.vision.calibrate.table_file import TableCalibration, write_table
from sim2real.vision.camera_file import read_setup
from sim2real.vision.locate import Locator
from sim2real.vision.photograph import smoothed
from sim2real.vision.track.detector import Detections
from sim2real.vision.track.tracker import Targets, Tracker
from tests.places import UBC

NAMES = ("clear", "half_hidden")
SETTINGS = CameraSettings(pixel_format="BayerRG8", region=RegionOfInterest(396, 20, 1300, 1450))
STATED = 1e-3  # m, greatest error that may be stated
NOISE = 2  # grey levels
pytestmark = [pytest.mark.slow, pytest.mark.skipif(not (UBC / "frames").is_dir(), reason="the frames are not here")]


@cache
def calibration() -> TableCalibration:
    """The table by its three photographs."""
    setup = read_setup(UBC / "calibration" / "camera.json")
    views = [read_view(UBC / "calibration" / f"view_{k}", setup) for k in (1, 2, 3)]
    return TableCalibration.of(setup, solve(setup, tuple(views)))


@cache
def pictures() -> tuple[np.ndarray, ...]:
    return tuple(read_grey(UBC / "frames" / f"{name}.png") for name in NAMES)


def found(seed: int | None) -> tuple[list[Detections], Tracker]:
    """What is found in both frames, each with noise that the seed draws if it is given."""
    rng = np.random.default_rng(seed)
    tracker, seen = Tracker(calibration(), Targets(None, 0.09, 75.0), SETTINGS, stills=True), []
    for k, image in enumerate(pictures()):
        noise = 0 if seed is None else rng.integers(-NOISE, NOISE + 1, image.shape)
        seen.append(tracker.add(Frame(np.clip(image + noise, 0, 255).astype(np.uint8), k / 120, k / 120, k)))
    return seen, tracker


def places(seen: list[Detections]) -> np.ndarray:
    """Puck and ring in each frame (frames, 2, 2) [m], NaN where one is not found."""
    states = [[one.puck, one.opponent] for one in seen]
    return np.array([[(np.nan, np.nan) if state is None else state.place for state in both] for both in states])


def test_puck_and_ring_are_found_in_both() -> None:
    """The ring did not move between the frames; the film is as large as its picture at 1.9 m, near to the report's."""
    seen, tracker = found(None)
    at = places(seen)
    assert np.isfinite(at).all() and [one.pucks for one in seen] == [1, 1]
    assert all(state and state.deviation < STATED for one in seen for state in (one.puck, one.opponent))
    assert np.linalg.norm(at[0, 1] - at[1, 1]) < 0.5e-3
    assert at[1, 0] == pytest.approx((0.878, 0.306), abs=3e-3)  # as it was found by hand, with an assumed radius
    assert tracker.film.radius == pytest.approx(0.0309, abs=1.5e-3) and tracker.film.covariance[0, 0] < 0.5e-3**2
    assert tracker.pose is not None and len(tracker.pose.residuals) == 16 and tracker.pose.rms < 0.5


def halfway_line(image: np.ndarray, locator: Locator) -> np.ndarray:
    """Where along the table [m] the line across its middle is seen, at places left and right of the logo: the centroid
    of what is brighter than a third of it."""
    x, even, found = np.linspace(1.15, 1.22, 141), smoothed(image), []
    for y in (0.1, 0.2, 0.3, 0.4, 0.75, 0.85, 0.95, 1.03):
        rows = [np.column_stack([x, np.full_like(x, y + d)]) for d in np.linspace(-0.015, 0.015, 7)]
        seen = [map_coordinates(even, locator.pixels(row, 0.0).T[::-1], order=1) for row in rows]
        level = np.mean(seen, axis=0)
        light = np.clip(level - np.median(level) - 0.3 * np.ptp(level), 0.0, None)
        found.append((light * x).sum() / light.sum())
    return np.array(found)


def test_the_halfway_line_is_where_the_photographs_have_it() -> None:
    """Nothing that locates the camera uses it: it tells how far its pose, along the table, can be trusted."""
    table, (image, _), (_, tracker) = calibration(), pictures(), found(None)
    assert tracker.locator is not None
    photograph = read_grey(UBC / "calibration" / "view_3" / "view.png")
    pose, _ = find_camera(table.setup, table.geometry, photograph)
    before = Locator(table.setup.camera, pose.motion, table.geometry.surface, table.geometry.warp)
    off = halfway_line(image, tracker.locator) - halfway_line(photograph, before)
    assert abs(off.mean()) < 2.0 * tracker.place_std < STATED and off.std() < 0.3e-3


def test_noise_changes_little() -> None:
    quiet = places(found(None)[0])
    noisy = np.array([places(found(seed)[0]) for seed in range(2)])
    assert np.abs(noisy - quiet).max() < 0.3e-3


def test_the_command_says_so(tmp_path: Path, capsys) -> None:
    file = tmp_path / "table.json"
    setup = read_setup(UBC / "calibration" / "camera.json")
    views = [read_view(UBC / "calibration" / f"view_{k}", setup) for k in (1, 2, 3)]
    write_table(file, setup, solve(setup, tuple(views)))
    command = ["track", str(UBC / "frames"), "--calibration", str(file), "--stills"]
    assert puckpilot.main([*command, "--out", str(tmp_path / "no")]) == 2
    error = capsys.readouterr().err
    assert error.count("\n") == 1 and "1300x1450" in error and "--region" in error
    region = ["--region", "1300x1450+396+20", "--mosaic"]
    assert puckpilot.main([*command, *region, "--out", str(tmp_path / "out")]) == 0
    output = capsys.readouterr().out
    assert output.startswith("2 frames: puck known in 2, hidden in 0, not sure in 0")
    assert "picture 1: puck (0.87" in output


def main() -> None:
    """Print how far places scatter in draws of noise."""
    draws = int(sys.argv[1])
    at = np.array([places(found(seed)[0]) for seed in range(draws)])
    counts = np.isfinite(at).all(axis=3).sum(axis=0)
    off = 1e3 * np.linalg.norm(at - np.nanmean(at, axis=0), axis=3)
    for k, name in enumerate(NAMES):
        for j, what in enumerate(("puck", "ring")):
            x, y = np.nanmean(at[:, k, j], axis=0)
            print(
                f"{name}: {what} found in {counts[k, j]} of {draws}, ({x:.5f}, {y:.5f}) m on average, "
                f"{np.sqrt(np.nanmean(off[:, k, j] ** 2)):.3f} mm rms off it, {np.nanmax(off[:, k, j]):.3f} at most"
            )


if __name__ == "__main__":
    main()
