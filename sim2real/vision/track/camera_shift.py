"""Notice a camera that was moved, by tracking the markers from the first picture on with optical flow."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.frame_monitor import Trouble

AROUND = 40  # px round a marker in which it is searched
MOST = 0.5  # px, tolerated shift of a marker; about a millimetre on the table
DIM = 2.0  # grey levels, least standard deviation of a marker and its surroundings in the first picture
TOGETHER = (0.5, 0.1)  # px, and share of the shift, by which the corners of a marker may move differently
FLOW = {"winSize": (15, 15), "maxLevel": 2, "criteria": (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 20, 0.01)}


class CameraShift:
    """Tracks markers by optical flow (Lucas and Kanade 1981) from a first picture uint8 (rows, columns), in which their
    corners (4, 2) [pixels] are known by id.

    It takes a fraction of a millisecond for each marker; to detect markers anew would take the time of thirty pictures.
    """

    def __init__(self, first: np.ndarray, corners: dict[int, np.ndarray]) -> None:
        markers = [_Marker(first, one) for one in corners.values()]
        self._markers = [marker for marker in markers if marker.spread >= DIM]

    def __len__(self) -> int:
        """The number of markers that are bright enough to be tracked."""
        return len(self._markers)

    def shifts(self, image: np.ndarray) -> np.ndarray:
        """The shifts (n,) [pixels] of the n markers that are clearly seen in a picture; up to about 20 px are found."""
        found = [marker.shift(image) for marker in self._markers]
        return np.array([shift for shift in found if shift is not None])


def markers_hidden() -> Trouble:
    """The trouble that no marker is seen in its place."""
    return Trouble(
        "markers lost",
        "no marker is seen where it was in the first picture; see whether all are hidden or the lamp is off",
    )


def camera_moved(shifts: np.ndarray) -> Trouble:
    """The trouble that markers are shifted (n,) [pixels]."""
    return Trouble(
        "moved camera",
        f"{int((shifts > MOST).sum())} of {len(shifts)} markers are up to {shifts.max():.1f} px from where they were: "
        "fix camera and markers; positions are left out from the last good check until the camera is located again",
    )


class _Marker:
    def __init__(self, first: np.ndarray, corners: np.ndarray) -> None:
        low = np.maximum(np.floor(corners.min(axis=0)) - AROUND, 0).astype(int)
        high = np.ceil(corners.max(axis=0)).astype(int) + AROUND
        self._part = slice(low[1], high[1]), slice(low[0], high[0])
        self._first = np.ascontiguousarray(first[self._part])
        self._mean, self.spread = float(self._first.mean()), float(self._first.std())
        self._corners = (corners - low).astype(np.float32)

    def shift(self, image: np.ndarray) -> float | None:
        now, seen, _ = cv2.calcOpticalFlowPyrLK(
            self._first, self._as_bright(image[self._part]), self._corners, np.empty_like(self._corners), **FLOW
        )
        moves = now - self._corners
        move = np.median(moves, axis=0)
        shift = float(np.hypot(*move))
        apart = float(np.hypot(*(moves - move).T).max())
        return shift if seen.all() and apart < TOGETHER[0] + TOGETHER[1] * shift else None

    def _as_bright(self, part: np.ndarray) -> np.ndarray:
        """The part with the mean and the contrast of the first picture, because optical flow assumes constant
        brightness."""
        grey = part.astype(np.float32)
        gain = self.spread / max(float(grey.std()), 1.0)
        return np.clip(gain * (grey - grey.mean()) + self._mean, 0.0, 255.0).astype(np.uint8)
