"""Whether a view's points can be what it shows: axes swapped, sizes in other units, a table seen edge-on."""

from __future__ import annotations

import numpy as np

from sim2real.vision.bend import Bend
from sim2real.vision.calibrate.view import View
from sim2real.vision.camera import Camera
from sim2real.vision.locate import Locator
from sim2real.vision.motion import rotation
from sim2real.vision.surface import Surface

FAR = 0.01  # m, of the points' root mean square: more than any table is warped
EDGE_ON = 10.0  # degrees that the camera must see the whole table from above


def check_view(camera: Camera, view: View, motion: np.ndarray, height: float) -> None:
    """See that the rough motion (6,) of a view's camera makes sense. ValueError, in one line, if not."""
    origin = -rotation(motion[:3]).T @ motion[3:]
    low, high = (tuple(float(one) for one in end(view.places, axis=0)) for end in (np.min, np.max))
    flat = Bend(((low[0], low[1]), (high[0], high[1])))
    off = Locator(camera, motion, Surface((0.0, 0.0)), flat).places(view.pixels, height) - view.places
    far = float(np.sqrt(np.nanmean((off**2).sum(axis=1)))) if np.isfinite(off).any() else np.inf
    level = np.degrees(np.arctan2(origin[2], np.hypot(*(view.places - origin[:2]).T).max()))
    if 0.0 < level < EDGE_ON and far < 10.0 * FAR:
        raise ValueError(
            f"{view.name}: the table is seen edge-on, its far end from {level:.0f} degrees above; expected "
            f"{EDGE_ON:.0f} at least ({1e3 * far:.0f} mm rms on a flat table): put the camera higher"
        )
    if origin[2] < 0.0 and far < FAR:
        raise ValueError(
            f"{view.name}: the points are mirrored: they fit to {1e3 * far:.1f} mm, but with the camera "
            f"{-origin[2]:.2f} m under the table; are x and y swapped, or is y counted from the left?"
        )
    if not far < FAR:
        raise ValueError(
            f"{view.name}: on a flat table the points are {1e3 * far:.0f} mm from where they are seen; expected "
            f"{1e3 * FAR:.0f} at most: do lines belong together, and are x and y metres of this table?"
        )
