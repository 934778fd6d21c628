"""Whether the camera still stands where it did: the calibration's markers, looked for again."""

from __future__ import annotations

import numpy as np

from sim2real.camera.watch import Trouble
from sim2real.vision.camera import Camera
from sim2real.vision.markers import find_markers
from sim2real.vision.motion import moved
from sim2real.vision.scene import Scene

MOST = 0.5  # px rms beyond what the markers were off in the first picture; it is a millimetre on the table


class Moved:
    """Looks for markers where a camera of this `motion` (6,) should see them; `first` [pixels] is how far off they were
    in the picture that it was found from, root mean square."""

    def __init__(self, camera: Camera, dictionary: str, scene: Scene, motion: np.ndarray, first: float) -> None:
        self._camera, self._dictionary, self._first = camera, dictionary, first
        self._expected = {
            marker: camera.project(moved(motion, corners)[0])[0] for marker, corners in scene.markers.items()
        }

    def residual(self, image: np.ndarray) -> float | None:
        """How far off [pixels] markers are, root mean square; None where too few are seen, as when people stand before
        them."""
        try:
            seen = find_markers(image, self._camera, self._dictionary)
        except ValueError:
            return None
        shared = [marker for marker in self._expected if marker in seen]
        off = [seen[marker] - self._expected[marker] for marker in shared]
        return float(np.sqrt((np.concatenate(off) ** 2).sum(axis=1).mean())) if off else None

    def check(self, image: np.ndarray) -> Trouble | None:
        """What is wrong, in the manner of `camera.watch`."""
        found = self.residual(image)
        if found is None or found <= self._first + MOST:
            return None
        return Trouble(
            "moved camera",
            f"markers are {found:.1f} px from where they should be, {self._first:.1f} at first: the camera or a marker "
            "was moved; begin again, and fix it",
        )
