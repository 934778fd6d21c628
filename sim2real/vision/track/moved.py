"""Whether the camera still stands where it did: markers, followed from the first picture on."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.camera.watch import Trouble

AROUND = 40  # px round a marker that are looked at
MOST = 0.5  # px that a marker may be from where it was; it is a millimetre on the table
TOGETHER = (0.5, 0.1)  # px, and of its shift, that a marker's corners may differ in how they moved: a camera turns
FOLLOW = {"winSize": (15, 15), "maxLevel": 2, "criteria": (cv2.TERM_CRITERIA_EPS | cv2.TERM_CRITERIA_COUNT, 20, 0.01)}


class Moved:
    """Follows the corners (4, 2) [pixels] of markers that were found in a first picture, by optical flow (Lucas and
    Kanade 1981), in a fraction of a millisecond each: to find markers anew would take the time of thirty pictures."""

    def __init__(self, first: np.ndarray, corners: dict[int, np.ndarray]) -> None:
        self._markers = [_Marker(first, one) for one in corners.values()]

    def shifts(self, image: np.ndarray) -> np.ndarray:
        """How far [pixels] each marker is from where it was; only of those that are clearly seen, up to some 20 px."""
        found = [marker.shift(image) for marker in self._markers]
        return np.array([shift for shift in found if shift is not None])


def hidden() -> Trouble:
    """No marker is where it was."""
    return Trouble(
        "markers lost",
        "no marker is seen where it was in the first picture; see whether all are hidden or the lamp is off",
    )


def moved(shifts: np.ndarray) -> Trouble:
    """Markers are, by these shifts (n,) [pixels], not where they were."""
    return Trouble(
        "moved camera",
        f"{int((shifts > MOST).sum())} of {len(shifts)} markers are up to {shifts.max():.1f} px from where they were: "
        "fix camera and markers; positions are left out from the last good look to the next that tells its place",
    )


class _Marker:
    def __init__(self, first: np.ndarray, corners: np.ndarray) -> None:
        low = np.maximum(np.floor(corners.min(axis=0)) - AROUND, 0).astype(int)
        high = np.ceil(corners.max(axis=0)).astype(int) + AROUND
        self._part = slice(low[1], high[1]), slice(low[0], high[0])
        self._first = np.ascontiguousarray(first[self._part])
        self._mean, self._spread = float(self._first.mean()), float(self._first.std())
        self._corners = (corners - low).astype(np.float32)

    def shift(self, image: np.ndarray) -> float | None:
        now, seen, _ = cv2.calcOpticalFlowPyrLK(
            self._first, self._as_bright(image[self._part]), self._corners, np.empty_like(self._corners), **FOLLOW
        )
        moves = now - self._corners
        move = np.median(moves, axis=0)
        shift = float(np.hypot(*move))
        apart = float(np.hypot(*(moves - move).T).max())
        return shift if seen.all() and apart < TOGETHER[0] + TOGETHER[1] * shift else None

    def _as_bright(self, part: np.ndarray) -> np.ndarray:
        """The part as the first was lit: flow takes brightness for constant."""
        grey = part.astype(np.float32)
        gain = self._spread / max(float(grey.std()), 1.0)
        return np.clip(gain * (grey - grey.mean()) + self._mean, 0.0, 255.0).astype(np.uint8)
