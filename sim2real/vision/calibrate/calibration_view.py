"""A view for the calibration of a table: a folder with view.png, a photograph, and pixels.csv, measured points."""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from sim2real.camera.grey_image import read_grey
from sim2real.recording.stream_csv import read_stream
from sim2real.vision.camera_file import Setup
from sim2real.vision.markers import find_markers
from sim2real.vision.photograph import check_size

COLUMNS = ("u", "v", "x", "y")
FEWEST = 6  # measured points in a view: those that the camera's pose needs, and some to test it


@dataclass(frozen=True)
class CalibrationView:
    """What one pose of the camera shows.

    corners: by a marker's id, its corners (4, 2) [pixels]; pixels: (n, 2), where the puck's centre was seen when it lay
    at `places`, (n, 2) [m], measured by hand.
    """

    name: str
    corners: dict[int, np.ndarray]
    pixels: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))
    places: np.ndarray = field(default_factory=lambda: np.zeros((0, 2)))


def read_view(folder: Path, setup: Setup) -> CalibrationView:
    """Read a view: find the markers in its photograph and read its measured points. Raises ValueError, in one line, if
    something is missing or wrong."""
    if not folder.is_dir():
        raise ValueError(f"{folder} is no folder; a view is a folder with view.png and pixels.csv")
    file = folder / "view.png"
    image = read_grey(file)
    check_size(file, image, setup.camera)
    try:
        corners = find_markers(image, setup.camera, setup.dictionary)
    except ValueError as error:
        raise ValueError(f"{file}: {error}") from None
    pixels, places = read_points(folder / "pixels.csv", image.shape[1], image.shape[0], setup)
    return CalibrationView(folder.resolve().name, corners, pixels, places)


def read_points(file: Path, wide: int, high: int, setup: Setup) -> tuple[np.ndarray, np.ndarray]:
    """Read pixels (n, 2) and places (n, 2) [m] of a view's points from pixels.csv.

    wide, high: size of the photograph [pixels]. Raises ValueError, in one line, for too few points, blank cells, and
    points outside of the picture or off the table.
    """
    table = read_stream(file, COLUMNS)
    u, v, x, y = (table[name] for name in COLUMNS)
    pixels, places = np.stack([u, v], axis=1), np.stack([x, y], axis=1)
    if len(u) < FEWEST:
        raise ValueError(f"{file} holds {len(u)} points; expected {FEWEST} at least, over the whole table")
    blank = np.isnan(u + v + x + y)
    if blank.any():
        raise ValueError(f"{file}: point {_first(blank)} has a blank cell; expected numbers in all")
    out = np.any((pixels < -0.5) | (pixels > (wide - 0.5, high - 0.5)), axis=1)
    if out.any():
        k = int(np.argmax(out))
        raise ValueError(
            f"{file}: point {_first(out)} is seen at ({u[k]:.0f}, {v[k]:.0f}); expected pixels in a picture of "
            f"{wide}x{high}: are u and v swapped?"
        )
    beyond = _beyond(places, setup.length, setup.width)
    if beyond.any():
        k = int(np.argmax(beyond))
        swapped = not _beyond(places[:, ::-1], setup.length, setup.width).any()
        hint = "swap x and y: x is along the table" if swapped else "give metres, or the right table in camera.json"
        raise ValueError(
            f"{file}: {int(beyond.sum())} of {len(u)} points lie off the table of {setup.length:g} by {setup.width:g} "
            f"m, point {_first(beyond)} at ({x[k]:.3f}, {y[k]:.3f}); {hint}"
        )
    return pixels, places


def _beyond(places: np.ndarray, length: float, width: float) -> np.ndarray:
    return np.any((places < 0.0) | (places > (length, width)), axis=1)


def _first(wrong: np.ndarray) -> int:
    """The number of the first wrong point, counted from 1."""
    return int(np.argmax(wrong)) + 1
