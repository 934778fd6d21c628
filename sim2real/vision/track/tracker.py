"""Frames in, a recording out: finds the camera's place from the first picture, then puck and opponent in each."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.camera.frame import Frame
from sim2real.camera.watch import Trouble
from sim2real.recording import Recording
from sim2real.recording_checks import FORMAT
from sim2real.recording_csv import Stream
from sim2real.vision.calibrate.pose import camera_pose
from sim2real.vision.calibrate.table_file import Table
from sim2real.vision.locate import Locator
from sim2real.vision.markers import find_markers
from sim2real.vision.track.eye import Eye, Seen
from sim2real.vision.track.follow import Estimate
from sim2real.vision.track.moved import Moved

COLUMNS = ("t", "puck_x", "puck_y", "opponent_x", "opponent_y")
NOWHERE = (np.nan, np.nan)


@dataclass(frozen=True)
class Things:
    """What is looked for: the puck's radius, the height of the opponent's ring above the table [m], and the grey level
    above which film shines, in the middle of the table."""

    puck_radius: float
    ring_height: float
    level: float


class Tracker:
    """Give it sound frames in order of time."""

    def __init__(self, table: Table, things: Things) -> None:
        self._table, self.things = table, things
        self._eye: Eye | None = None
        self._moved: Moved | None = None
        self._rows: list[tuple[float, ...]] = []
        self.locator: Locator | None = None
        self.seen = self.hidden = self.unsure = (
            0  # frames: the puck is known, there is none, or what there is is not it
        )

    def add(self, frame: Frame) -> Seen:
        """Look at one. ValueError, in one line, if the first does not show where the camera is."""
        eye = self._eye or self._begin(frame.image)
        found = eye.look(frame.image, frame.time)
        self._rows.append((frame.time, *_cells(found.puck), *_cells(found.opponent)))
        self.seen += found.puck is not None
        self.hidden += found.puck is None and not found.pucks
        self.unsure += found.puck is None and found.pucks > 0
        return found

    def moved(self, image: np.ndarray) -> Trouble | None:
        """A check for `camera.watch.Watch`: whether the camera is where it was."""
        return self._moved.check(image) if self._moved else None

    def recording(self, name: str, note: str) -> Recording:
        """All that was seen so far. Nominal values that no picture tells are None."""
        columns = np.array(self._rows, dtype=float).reshape(-1, len(COLUMNS)).T
        setup, step = self._table.setup, np.diff(columns[0])
        meta = {
            "format": FORMAT,
            "table": {"length_m": setup.length, "width_m": setup.width, "goal_width_m": setup.goal_width},
            "puck": {"radius_m": self.things.puck_radius},
            "mallet": {"radius_m": None},
            "camera": {"rate_hz": float(1.0 / np.median(step)) if len(step) else None, "position_std_m": None},
            "note": note,
        }
        return Recording(name, meta, frames=Stream(dict(zip(COLUMNS, columns, strict=True))))

    def _begin(self, image: np.ndarray) -> Eye:
        setup, scene, things = self._table.setup, self._table.scene, self.things
        try:
            corners = find_markers(image, setup.camera, setup.dictionary)
            pose = camera_pose(setup, scene, corners)
        except ValueError as error:
            raise ValueError(f"the first picture does not tell where the camera is: {error}") from None
        self.locator = Locator(setup.camera, pose.motion, scene.surface, scene.bend)
        self._moved = Moved(setup.camera, setup.dictionary, scene, pose.motion, pose.rms)
        self._eye = Eye(
            self.locator, image.shape[::-1], length=setup.length, width=setup.width, puck_radius=things.puck_radius,
            puck_height=setup.puck_top, ring_height=things.ring_height, level=things.level,
        )  # fmt: skip
        return self._eye


def _cells(there: Estimate | None) -> tuple[float, float]:
    return NOWHERE if there is None else (float(there.place[0]), float(there.place[1]))
