"""A camera's intrinsics from photographs of a board (report B.1)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.camera import Camera

FEWEST = 5  # photographs; a dozen, from all sides, is better
EDGE_ON = 75.0  # degrees of tilt, beyond which corners smear
UNSURE = 0.01  # of the focal length that it may be uncertain
ROUGH = 1.0  # px, root mean square: more is no board, or another one


@dataclass(frozen=True)
class Intrinsics:
    """`std`: of fx, fy, cx, cy [pixels], k1, k2, p1, p2, k3; `rms` [pixels] and `tilt` [degrees] of each photograph."""

    camera: Camera
    std: np.ndarray
    rms: np.ndarray
    tilt: np.ndarray


def calibrate(names: list[str], seen: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> Intrinsics:
    """Fit the intrinsics to boards' corners, on the board (n, 3) and in the picture (n, 2), of photographs of some
    width and height. ValueError, in one line, where they do not tell them."""
    if len(seen) < FEWEST:
        raise ValueError(f"the board is seen in {len(seen)} photographs; expected {FEWEST} at least, better a dozen")
    boards, pixels = [one for one, _ in seen], [other for _, other in seen]
    found = cv2.calibrateCameraExtended(boards, pixels, size, np.eye(3), np.zeros(5))
    _, k, bent, turns, _, std, _, rms = found
    tilt = np.array([_tilt(cv2.Rodrigues(turn)[0]) for turn in turns])
    rms, std = np.ravel(rms), np.ravel(std)[:9]
    worst = int(np.argmax(rms))
    if tilt.max() > EDGE_ON:
        steep = int(np.argmax(tilt))
        raise ValueError(
            f"{names[steep]}: the board is seen edge-on, tilted by {tilt[steep]:.0f} degrees, {rms[steep]:.2f} px rms; "
            f"expected {EDGE_ON:.0f} at most: leave it out"
        )
    if rms[worst] > ROUGH:
        raise ValueError(
            f"{names[worst]}: corners are {rms[worst]:.1f} px rms from where the board has them; expected "
            f"{ROUGH:.0f} at most: is the board flat, and its number of corners right?"
        )
    if std[0] > UNSURE * k[0, 0]:
        raise ValueError(
            f"the focal length is uncertain by {100 * std[0] / k[0, 0]:.0f} %, tilts are {tilt.min():.0f} to "
            f"{tilt.max():.0f} degrees; expected 1 %: take more with the board tilted by 20 to 45 degrees"
        )
    k1, k2, p1, p2, k3 = (float(one) for one in np.ravel(bent)[:5])
    camera = Camera(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)
    return Intrinsics(camera, std, rms, tilt)


def _tilt(turn: np.ndarray) -> float:
    """The angle [degrees] between a board's normal and the camera's axis."""
    return float(np.degrees(np.arccos(min(1.0, abs(turn[2, 2])))))
