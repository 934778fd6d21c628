"""From frames to a recording: locates the camera in the first picture, then puck and opponent in each."""

from __future__ import annotations

import math
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.camera.frame import Frame
from sim2real.camera.frame_monitor import Trouble
from sim2real.camera.settings import CameraSettings
from sim2real.recording.checks import FORMAT
from sim2real.recording.folder import Recording
from sim2real.recording.stream_csv import Stream
from sim2real.vision.calibrate.find_camera import clear_markers, find_camera
from sim2real.vision.calibrate.place_uncertainty import pose_place_std
from sim2real.vision.calibrate.pose import Pose
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.camera import CameraModel
from sim2real.vision.locate import Locator
from sim2real.vision.markers import FEWEST
from sim2real.vision.mosaic import GreyOfMosaic
from sim2real.vision.photograph import check_size
from sim2real.vision.track.camera_shift import MOST, CameraShift, camera_moved, markers_hidden
from sim2real.vision.track.detector import Detections, Detector
from sim2real.vision.track.film import Film, FilmGauge
from sim2real.vision.track.kalman_tracker import TrackState

COLUMNS = ("t", "puck_x", "puck_y", "opponent_x", "opponent_y")
NOWHERE = (np.nan, np.nan)
BLIND = -1  # in place of the number of candidates, for a picture in which the camera's pose is unknown


@dataclass(frozen=True)
class Targets:
    """The objects to be tracked.

    puck_radius: of the puck's film [m], None to measure it; ring_height: of the opponent's ring above the table [m];
    level: grey level above which film counts as bright, in the middle of the table.
    """

    puck_radius: float | None
    ring_height: float
    level: float


class Tracker:
    """Tracks puck and opponent through valid frames in order of time.

    settings: of the camera, which say what its pictures are; stills: whether each picture is a scene of its own; live:
    whether what is found is needed at once, and not kept for `recording` and `counts`.
    locator: of the camera at present, None while its pose is unknown; pose: the last one found, None before the first.
    """

    def __init__(
        self, table: TableCalibration, targets: Targets, settings: CameraSettings | None = None, stills: bool = False,
        live: bool = False,
    ) -> None:  # fmt: skip
        self._settings, self._stills, self._live = settings or CameraSettings(), stills, live
        region, whole = self._settings.region, table.setup.camera
        self._whole = table.setup
        self._table = (
            table if region is None else replace(table, setup=replace(table.setup, camera=whole.cropped(region)))
        )
        self.targets = targets
        radius = targets.puck_radius
        self._film = FilmGauge(BY_NAME["puck_radius"].default) if radius is None else Film.known(radius)
        self._detector: Detector | None = None
        self._shift: CameraShift | None = None
        self._rows: list[tuple[float, ...]] = []  # COLUMNS, and the number of candidates for the puck
        self._several = False  # whether the last check saw more than one puck
        self._trusted = 0  # rows up to the last check that found the camera in its place
        self.locator: Locator | None = None
        self.pose: Pose | None = None

    def set_up(self, image: np.ndarray) -> None:
        """Locate the camera by a picture uint8 (rows, columns) of its whole sensor, so that no other has to show
        markers. Raises ValueError, in one line, if it is not such a picture of this table."""
        check_size("the setup picture", image, self._whole.camera)
        try:
            self.pose = find_camera(self._whole, self._table.geometry, image)[0]
        except ValueError as error:
            raise ValueError(f"the camera cannot be located in the setup picture: {error}") from None

    def add(self, frame: Frame) -> Detections:
        """Detect puck and opponent in one frame. Raises ValueError, in one line, if the first frame does not show
        enough markers to locate the camera and no setup picture did."""
        if self._shift is None:
            self._start(frame.image)
        if self._detector is None:
            found = Detections(None, None, BLIND)
        elif self._stills:
            found = self._detector.detect_alone(frame.image, frame.time)
        else:
            found = self._detector.detect(frame.image, frame.time)
        if not self._live:
            self._rows.append((frame.time, *_cells(found.puck), *_cells(found.opponent), found.pucks))
        return found

    def keep_warm(self, frame: Frame) -> None:
        """See `Detector.keep_warm`; for the last frame."""
        if self._detector is not None:
            self._detector.keep_warm(frame.image, frame.time)

    def check_camera(self, image: np.ndarray) -> Trouble | None:
        """Check, for `FrameMonitor`, whether the camera is still in its place in a picture uint8 (rows, columns).

        If it is not, the positions since the last successful check are discarded, and the camera is located anew as
        soon as a picture shows enough markers.
        """
        if self._shift is None:
            return None
        shifts = self._shift.shifts(self._grey(image))
        if not len(self._shift):
            return None  # the camera was located by a setup picture, and the markers are too dim to be watched
        if self._detector and not len(shifts):
            return markers_hidden()
        if self._detector and shifts.max() <= MOST:
            self._trusted = len(self._rows)
            return None
        self._rows[self._trusted :] = [(row[0], *NOWHERE, *NOWHERE, BLIND) for row in self._rows[self._trusted :]]
        self._detector = self.locator = None
        with suppress(ValueError):
            self._begin(image, FEWEST + 1)
            self._trusted = len(self._rows)
        return camera_moved(shifts) if len(shifts) else markers_hidden()

    def check_pucks(self, image: np.ndarray) -> Trouble | None:
        """Check, for `FrameMonitor`, whether two pictures uint8 (rows, columns) in a row show more than one puck.

        A puck that is tracked is searched where it must be; another one is seen in the whole picture alone.
        """
        pucks = self._detector.count_pucks(image) if self._detector else 0
        before, self._several = self._several, pucks > 1
        return several_pucks(pucks) if before and self._several else None

    @property
    def camera(self) -> CameraModel:
        """The camera of the pictures: the calibrated one, of which they show the region of interest."""
        return self._table.setup.camera

    @property
    def sensor(self) -> tuple[int, int] | None:
        """Width and height of the calibrated camera's whole sensor [pixels], None if unknown."""
        return self._whole.camera.size

    @property
    def film(self) -> Film:
        """The puck's film: the given one, or what was measured up to now."""
        return self._film.film if isinstance(self._film, FilmGauge) else self._film

    @property
    def place_std(self) -> float:
        """The typical error of calibration and pose along each axis [m], common to all pictures."""
        if not self._table.place_std or self.pose is None:
            return self._table.place_std
        return math.hypot(self._table.place_std, self._pose_std)

    @property
    def heights(self) -> tuple[float, float]:
        """The heights of the puck's top and of the opponent's ring above the table [m]."""
        return self._table.setup.puck_top, self.targets.ring_height

    @property
    def counts(self) -> dict[str, int]:
        """The number of frames with a known camera pose in which the puck's state is known ("seen"), in which there is
        no candidate for it ("hidden"), and in which there are candidates but the state is unknown ("unsure")."""
        known, pucks = (np.array([row[k] for row in self._rows]) for k in (1, -1))
        blank = np.isnan(known)
        return {"seen": int((~blank).sum()), "hidden": int((blank & (pucks == 0)).sum()),
                "unsure": int((blank & (pucks > 0)).sum())}  # fmt: skip

    def recording(self, name: str, note: str) -> Recording:
        """The recording of all frames so far. Nominal values that pictures do not show are None."""
        columns = np.array([row[: len(COLUMNS)] for row in self._rows], dtype=float).reshape(-1, len(COLUMNS)).T
        setup = self._table.setup
        rate = round(1.0 / float(np.median(np.diff(columns[0]))), 3) if len(self._rows) > 1 else None
        meta = {
            "format": FORMAT,
            "table": {"length_m": setup.length, "width_m": setup.width, "goal_width_m": setup.goal_width},
            "puck": {"radius_m": round(self.film.radius, 6)},
            "mallet": {"radius_m": None},
            "camera": {"rate_hz": rate, "position_std_m": None, "place_std_m": self.place_std or None},
            "note": note,
        }
        return Recording(name, meta, frames=Stream(dict(zip(COLUMNS, columns, strict=True))))

    def _start(self, image: np.ndarray) -> None:
        """Start with the first frame, in which the camera is located unless a setup picture did that."""
        if self.pose is None:
            try:
                return self._begin(image, FEWEST)
            except ValueError as error:
                raise ValueError(f"the camera cannot be located in the first picture: {error}") from None
        check_size("the first picture", image, self.camera)
        self._detect_from(self.pose, image, {})

    def _begin(self, image: np.ndarray, fewest: int) -> None:
        """Locate the camera by `fewest` markers at least, and start a detector. After a bump one more marker is
        required: three alone leave too little redundancy. ValueError, in one line, if that fails."""
        setup, geometry = self._table.setup, self._table.geometry
        check_size("it", image, setup.camera)
        pose, corners = find_camera(setup, geometry, image)
        if 4 * min(fewest, len(geometry.markers)) > len(pose.residuals):
            raise ValueError(f"{len(pose.residuals) // 4} markers are seen; expected {fewest} at least")
        self._detect_from(pose, image, corners)

    def _detect_from(self, pose: Pose, image: np.ndarray, corners: dict[int, np.ndarray]) -> None:
        """Start a detector for a pose, and watch the markers of a picture with corners (4, 2) [pixels], or those that
        are clear in it."""
        setup, geometry, targets = self._table.setup, self._table.geometry, self.targets
        corners = corners or clear_markers(setup, geometry, pose.motion, image)
        self.pose = pose
        self.locator = Locator(setup.camera, pose.motion, geometry.surface, geometry.warp)
        self._pose_std = pose_place_std(self.locator, pose.covariance, setup.length, setup.width)
        self._shift = CameraShift(self._grey(image), corners)
        self._detector = Detector(
            self.locator, image.shape[::-1], length=setup.length, width=setup.width, film=self._film,
            puck_height=setup.puck_top, ring_height=targets.ring_height, level=targets.level,
            calibration_error=self.place_std, mosaic=self._settings.mosaic, live=self._live,
        )  # fmt: skip

    def _grey(self, image: np.ndarray) -> np.ndarray:
        """A picture without its mosaic."""
        return GreyOfMosaic(image.shape[::-1]).part(image, None) if self._settings.mosaic else image


def several_pucks(number: int) -> Trouble:
    """The trouble that more than one puck is seen."""
    return Trouble("several pucks", f"{number} pucks are seen; leave one on the table")


def _cells(state: TrackState | None) -> tuple[float, float]:
    return NOWHERE if state is None else (float(state.place[0]), float(state.place[1]))
