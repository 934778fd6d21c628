"""A camera's intrinsics from photographs of a board (report B.1)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.calibrate.sway import sway
from sim2real.vision.camera import Camera

FEWEST = 5  # photographs; a dozen, from all sides, is better
EDGE_ON = 75.0  # degrees of tilt, beyond which corners smear
UNSURE = 0.01  # of the focal length that it and the principal point may be uncertain
ROUGH = 1.0  # px, root mean square: more is no board, or another one
APART = 2.5  # times the others' residuals: good photographs, near and far, have up to 1.5, a mirrored board over 3


@dataclass(frozen=True)
class Intrinsics:
    """`std`: of fx, fy, cx, cy [pixels], k1, k2, p1, p2, k3. Of each photograph: `rms` [pixels], the board's `tilt`
    [degrees], how far its corners are `off` where the others put the camera and how far off `others` are, as in
    `Sway.apart`, and whether the others contradict it."""

    camera: Camera
    std: np.ndarray
    rms: np.ndarray
    tilt: np.ndarray
    off: np.ndarray
    others: np.ndarray

    @property
    def contradicted(self) -> np.ndarray:
        return self.off > APART * self.others


def calibrate(names: list[str], seen: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> Intrinsics:
    """Fit the intrinsics to boards' corners, on the board (n, 3) and in the picture (n, 2), of photographs of some
    width and height. ValueError, in one line, where they do not tell them."""
    if len(seen) < FEWEST:
        raise ValueError(f"the board is seen in {len(seen)} photographs; expected {FEWEST} at least, better a dozen")
    _, k, bent, turns, shifts, _, _, rms = _fit(seen, size)
    tilt, rms = np.array([_tilt(cv2.Rodrigues(turn)[0]) for turn in turns]), np.ravel(rms)
    motions = [np.ravel([turn, shift]) for turn, shift in zip(turns, shifts, strict=True)]
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
    each = sway(seen, k, bent, motions)
    std = each.std()
    _check_sure(std, float(k[0, 0]), tilt)
    k1, k2, p1, p2, k3 = (float(one) for one in np.ravel(bent)[:5])
    camera = Camera(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)
    return Intrinsics(camera, std, rms, tilt, *each.apart())


def _fit(seen: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> tuple:
    """OpenCV's fit, begun at the focal length that it guesses from the boards' foreshortening and at the picture's
    width: the better one, for either start can lead astray where boards all but face the camera. On one thread, for
    several add up in an order of their own, and the same photographs would not give the same numbers."""
    boards, pixels = [one for one, _ in seen], [other for _, other in seen]
    wide = np.array([[size[0], 0.0, (size[0] - 1) / 2], [0.0, size[0], (size[1] - 1) / 2], [0.0, 0.0, 1.0]])
    begin = [(np.eye(3), 0), (wide, cv2.CALIB_USE_INTRINSIC_GUESS)]
    threads = cv2.getNumThreads()
    cv2.setNumThreads(1)
    try:
        fits = [
            cv2.calibrateCameraExtended(boards, pixels, size, one, np.zeros(5), flags=flags) for one, flags in begin
        ]
    finally:
        cv2.setNumThreads(threads)
    return min(fits, key=lambda fit: fit[0])


def _check_sure(std: np.ndarray, focal: float, tilt: np.ndarray) -> None:
    """ValueError where the boards' directions do not tell the focal lengths and the principal point."""
    unsure = std[:4] / focal
    if unsure.max() > UNSURE:
        what = "focal length" if unsure[:2].max() > UNSURE else "principal point"
        share = f"by {100 * unsure.max():.1f} %" if unsure.max() < 1.0 else "altogether"
        raise ValueError(
            f"the photographs do not tell the {what}: it is uncertain {share}, expected 1 % at most; tilts are "
            f"{tilt.min():.0f} to {tilt.max():.0f} degrees: take more with the board tilted by 20 to 45 degrees, this "
            "way and that"
        )


def _tilt(turn: np.ndarray) -> float:
    """The angle [degrees] between a board's normal and the camera's axis."""
    return float(np.degrees(np.arccos(min(1.0, abs(turn[2, 2])))))
