"""Checks of a view's measured points: swapped axes, wrong units, typing errors, a table that is seen edge-on."""

from __future__ import annotations

import numpy as np

from sim2real.vision.calibrate.calibration_view import CalibrationView
from sim2real.vision.calibrate.pose import rough_pose
from sim2real.vision.camera import CameraModel
from sim2real.vision.coordinate_warp import CoordinateWarp
from sim2real.vision.locate import Locator
from sim2real.vision.motion import rotation
from sim2real.vision.surface import Surface

FAR = 0.01  # m, root mean square residual on a flat table; warped tables have less
EDGE_ON = 10.0  # degrees, least elevation of the camera seen from the far end of the table
LINE = 0.02  # m, least root mean square distance of the points from a line
BLUNDERS = 6  # at most one point in so many is searched as a blunder


def checked_pose(camera: CameraModel, view: CalibrationView, height: float) -> np.ndarray:
    """The approximate pose (6,) of a view's camera (see `motion.py`), from its points on a flat table.

    height: of the puck's mark above the surface [m]. Raises ValueError, in one line with the likely cause, if the
    points do not fit a flat table that is seen from above.
    """
    across = np.linalg.svd(view.places - view.places.mean(axis=0))[1][-1] / np.sqrt(len(view.places))
    if across < LINE:
        raise ValueError(
            f"{view.name}: its points lie on one line, to {1e3 * across:.0f} mm; expected them all over the table"
        )
    motion = _rough(camera, view, height)
    off = _off(camera, view, motion, height)
    far = _rms(off[np.isfinite(off)])
    origin = -rotation(motion[:3]).T @ motion[3:]
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
    if not _rms(off) < FAR:
        raise ValueError(f"{view.name}: {_blunders(camera, view, height) or _nonsense(off, far)}")
    return motion


def _rough(camera: CameraModel, view: CalibrationView, height: float) -> np.ndarray:
    return rough_pose(camera, np.column_stack([view.places, np.full(len(view.places), height)]), view.pixels)


def _off(camera: CameraModel, view: CalibrationView, motion: np.ndarray, height: float) -> np.ndarray:
    """Distances (n,) [m] on a flat table between seen and measured points; infinite above the horizon."""
    flat = Locator(camera, motion, Surface((0.0, 0.0)), CoordinateWarp(((0.0, 0.0), (1.0, 1.0))))
    return np.nan_to_num(np.hypot(*(flat.places(view.pixels, height) - view.places).T), nan=np.inf)


def _rms(off: np.ndarray) -> float:
    return float(np.sqrt((off**2).mean())) if len(off) else np.inf


def _blunders(camera: CameraModel, view: CalibrationView, height: float) -> str:
    """The error text that names the few points without which the rest fit, found by leaving them out one by one; empty
    if there are no such points."""
    kept = np.arange(len(view.places))
    for _ in range(len(kept) // BLUNDERS):
        fewer = [np.delete(kept, k) for k in range(len(kept))]
        parts = [CalibrationView("", {}, view.pixels[some], view.places[some]) for some in fewer]
        motions = [_rough(camera, part, height) for part in parts]
        rms = [_rms(_off(camera, part, motion, height)) for part, motion in zip(parts, motions, strict=True)]
        best = int(np.argmin(rms))
        kept = fewer[best]
        if rms[best] < FAR:
            out = np.setdiff1d(np.arange(len(view.places)), kept)
            off = _off(camera, view, motions[best], height)[out]
            where = [f"{1e3 * far:.0f} mm" if np.isfinite(far) else "above the horizon" for far in off]
            listed = ", ".join(f"point {k + 1} ({far})" for k, far in zip(out, where, strict=True))
            return (
                f"not seen where measured: {listed}; the other {len(kept)} are, to {1e3 * rms[best]:.1f} mm: mend or "
                "delete the line in pixels.csv"
            )
    return ""


def _nonsense(off: np.ndarray, far: float) -> str:
    """The error text for points that fit no flat table."""
    past = int(np.isinf(off).sum())
    seen = f", {past} of them above its horizon" if past else ""
    return (
        f"on a flat table the points are {1e3 * far:.0f} mm from where they are seen{seen}; expected "
        f"{1e3 * FAR:.0f} at most: do lines belong together, and are x and y metres of this table?"
    )
