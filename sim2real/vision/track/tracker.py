"""Frames in, a recording out: finds the camera's place from the first picture, then puck and opponent in each."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import dataclass

import numpy as np

from sim2real.camera.frame import Frame
from sim2real.camera.watch import Trouble
from sim2real.recording import Recording
from sim2real.recording_checks import FORMAT
from sim2real.recording_csv import Stream
from sim2real.vision.calibrate.pose import Pose, camera_pose
from sim2real.vision.calibrate.table_file import Table
from sim2real.vision.camera import Camera
from sim2real.vision.locate import Locator
from sim2real.vision.markers import FEWEST, find_markers
from sim2real.vision.photograph import check_size
from sim2real.vision.track.eye import Eye, Seen
from sim2real.vision.track.follow import Estimate
from sim2real.vision.track.moved import MOST, Moved, hidden, moved

COLUMNS = ("t", "puck_x", "puck_y", "opponent_x", "opponent_y")
NOWHERE = (np.nan, np.nan)
BLIND = -1  # things that may be the puck, in a picture of a camera that nobody knows where it stands


@dataclass(frozen=True)
class Things:
    """What is looked for: the puck's radius, the height of the opponent's ring above the table [m], and the grey level
    above which film shines, in the middle of the table."""

    puck_radius: float
    ring_height: float
    level: float


class Tracker:
    """Give it sound frames in order of time. `locator`: the camera's place now, None while it is not known."""

    def __init__(self, table: Table, things: Things) -> None:
        self._table, self.things = table, things
        self._eye: Eye | None = None
        self._moved: Moved | None = None
        self._rows: list[tuple[float, ...]] = []  # COLUMNS, and how many things may be the puck
        self._trusted = 0  # rows up to the last look at which the camera stood where it did
        self.locator: Locator | None = None
        self.pose: Pose | None = None

    def add(self, frame: Frame) -> Seen:
        """Look at one. ValueError, in one line, if the first does not show where the camera is."""
        if self._moved is None:
            try:
                self._begin(frame.image, FEWEST)
            except ValueError as error:
                raise ValueError(f"the first picture does not tell where the camera is: {error}") from None
        found = self._eye.look(frame.image, frame.time) if self._eye else Seen(None, None, BLIND)
        self._rows.append((frame.time, *_cells(found.puck), *_cells(found.opponent), found.pucks))
        return found

    def moved(self, image: np.ndarray) -> Trouble | None:
        """A check for `camera.watch.Watch`: whether the camera is where it was. If not, what was seen since it last was
        is not known, and its place is found anew as soon as a picture tells it."""
        if self._moved is None:
            return None
        shifts = self._moved.shifts(image)
        if self._eye and not len(shifts):
            return hidden()
        if self._eye and shifts.max() <= MOST:
            self._trusted = len(self._rows)
            return None
        self._rows[self._trusted :] = [(row[0], *NOWHERE, *NOWHERE, BLIND) for row in self._rows[self._trusted :]]
        self._eye = self.locator = None
        with suppress(ValueError):
            self._begin(image, FEWEST + 1)
            self._trusted = len(self._rows)
        return moved(shifts) if len(shifts) else hidden()

    @property
    def camera(self) -> Camera:
        """The camera of the calibration."""
        return self._table.setup.camera

    @property
    def place_std(self) -> float:
        """How far off along each axis [m] the calibration typically has places, alike in all pictures."""
        return self._table.place_std

    @property
    def heights(self) -> tuple[float, float]:
        """Of the puck's top and of the opponent's ring above the table [m]."""
        return self._table.setup.puck_top, self.things.ring_height

    @property
    def counts(self) -> dict[str, int]:
        """Frames: in which the puck is known, in which there is none, and in which what there is is not it; of those
        in which the camera's place was known."""
        known, pucks = (np.array([row[k] for row in self._rows]) for k in (1, -1))
        blank = np.isnan(known)
        return {"seen": int((~blank).sum()), "hidden": int((blank & (pucks == 0)).sum()),
                "unsure": int((blank & (pucks > 0)).sum())}  # fmt: skip

    def recording(self, name: str, note: str) -> Recording:
        """All that was seen so far. Nominal values that no picture tells are None."""
        columns = np.array([row[: len(COLUMNS)] for row in self._rows], dtype=float).reshape(-1, len(COLUMNS)).T
        setup = self._table.setup
        rate = round(1.0 / float(np.median(np.diff(columns[0]))), 3) if len(self._rows) > 1 else None
        meta = {
            "format": FORMAT,
            "table": {"length_m": setup.length, "width_m": setup.width, "goal_width_m": setup.goal_width},
            "puck": {"radius_m": self.things.puck_radius},
            "mallet": {"radius_m": None},
            "camera": {"rate_hz": rate, "position_std_m": None, "place_std_m": self.place_std or None},
            "note": note,
        }
        return Recording(name, meta, frames=Stream(dict(zip(COLUMNS, columns, strict=True))))

    def _begin(self, image: np.ndarray, fewest: int) -> None:
        """By so many markers at least: three have little that could contradict them, which after a bump matters."""
        setup, scene, things = self._table.setup, self._table.scene, self.things
        check_size("it", image, setup.camera)
        corners = find_markers(image, setup.camera, setup.dictionary)
        pose = camera_pose(setup, scene, corners)
        if 4 * min(fewest, len(scene.markers)) > len(pose.residuals):
            raise ValueError(f"{len(pose.residuals) // 4} markers are seen; expected {fewest} at least")
        self.pose = pose
        self.locator = Locator(setup.camera, self.pose.motion, scene.surface, scene.bend)
        self._moved = Moved(image, corners)
        self._eye = Eye(
            self.locator, image.shape[::-1], length=setup.length, width=setup.width, puck_radius=things.puck_radius,
            puck_height=setup.puck_top, ring_height=things.ring_height, level=things.level,
            calibration_error=self.place_std,
        )  # fmt: skip


def _cells(there: Estimate | None) -> tuple[float, float]:
    return NOWHERE if there is None else (float(there.place[0]), float(there.place[1]))
