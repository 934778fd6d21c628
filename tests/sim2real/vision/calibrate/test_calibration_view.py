"""Views as folders: photographs and points that cannot be are refused in one line that names what is wrong."""

from __future__ import annotations

from dataclasses import replace
from functools import cache
from pathlib import Path

import cv2
import numpy as np
import pytest
from PIL import Image

from sim2real.camera.grey_image import read_grey
from sim2real.vision.calibrate.calibration_view import read_points, read_view
from sim2real.vision.photograph import check_size
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_multiview import SETUP

MOTION = world.camera_motion(world.CAMERA_PLACES[0])
PIXELS = world.seen(MOTION, world.puck_points(world.grid()))


@cache
def picture() -> np.ndarray:
    return world.photograph(MOTION)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    return world.write_view(tmp_path / "view", picture(), PIXELS, world.grid())


def test_a_view_is_read(folder: Path):
    view = read_view(folder, SETUP)
    assert view.name == "view" and sorted(view.corners) == list(range(6))
    np.testing.assert_allclose(view.pixels, PIXELS, atol=1e-6)
    np.testing.assert_allclose(view.places, world.grid(), atol=1e-6)


def test_a_picture_that_is_cut_off_is_named(folder: Path):
    whole = (folder / "view.png").read_bytes()
    for many in (len(whole) // 2, 40):
        (folder / "view.png").write_bytes(whole[:many])
        with pytest.raises(ValueError, match=r"view\.png (is cut off or damaged|cannot be read as a picture)"):
            read_view(folder, SETUP)


def test_a_colour_picture_is_named(folder: Path):
    cv2.imwrite(str(folder / "view.png"), cv2.cvtColor(picture(), cv2.COLOR_GRAY2BGR))
    with pytest.raises(ValueError, match=r"view\.png is a colour image; expected 8-bit grey"):
        read_view(folder, SETUP)


def test_deep_and_foreign_files_are_named(folder: Path):
    Image.fromarray(picture().astype(np.uint16) * 256).save(folder / "view.png")
    with pytest.raises(ValueError, match=r"view\.png is an image of mode I;16; expected 8-bit"):
        read_view(folder, SETUP)
    (folder / "view.png").write_text("no picture")
    with pytest.raises(ValueError, match=r"view\.png cannot be read as a picture"):
        read_view(folder, SETUP)
    (folder / "view.png").unlink()
    with pytest.raises(ValueError, match=r"cannot read .*view\.png: No such file"):
        read_view(folder, SETUP)
    with pytest.raises(ValueError, match="is no folder; a view is a folder"):
        read_view(folder / "view.png", SETUP)


def test_a_picture_of_another_size_is_named(folder: Path):
    cv2.imwrite(str(folder / "view.png"), cv2.resize(picture(), None, fx=0.5, fy=0.5))
    with pytest.raises(ValueError, match="is 1024x768 pixels; expected 2048x1536, for which the camera is calibrated"):
        read_view(folder, SETUP)
    image = read_grey(folder / "view.png")
    unknown = replace(SETUP.camera, size=None)
    with pytest.raises(ValueError, match=r"1024x768 pixels, but the camera's principal point is \(1018, 772\)"):
        check_size(folder / "view.png", image, unknown)
    check_size(folder / "view.png", picture(), unknown)


def test_markers_are_missed_by_the_files_name(folder: Path):
    cv2.imwrite(str(folder / "view.png"), np.full_like(picture(), 90))
    with pytest.raises(ValueError, match=r"view\.png: 0 markers of DICT_4X4_50 are seen; expected 3"):
        read_view(folder, SETUP)


@pytest.mark.parametrize(
    "pixels, places, message",
    [
        (PIXELS, world.grid()[:, ::-1], r"\d+ of 36 points lie off the table of 2 by 1 m, point \d+ .*; swap x and y"),
        (PIXELS, 39.37 * world.grid(), r"points lie off the table of 2 by 1 m, .*; give metres, or the right table"),
        (PIXELS[:, ::-1] * [1.5, 1.2], world.grid(), r"point \d+ is seen at .*2048x1536: are u and v swapped"),
        (PIXELS[:5], world.grid()[:5], "holds 5 points; expected 6 at least"),
        (np.where(np.arange(36)[:, None] == 3, np.nan, PIXELS), world.grid(), "point 4 has a blank cell"),
    ],
)
def test_points_that_cannot_be_are_named(tmp_path: Path, pixels: np.ndarray, places: np.ndarray, message: str):
    rows = np.column_stack([pixels, places])
    text = "u,v,x,y\n" + "".join(",".join("" if np.isnan(c) else f"{c:.4f}" for c in row) + "\n" for row in rows)
    (tmp_path / "pixels.csv").write_text(text)
    with pytest.raises(ValueError, match=message):
        read_points(tmp_path / "pixels.csv", *world.SIZE, SETUP)
