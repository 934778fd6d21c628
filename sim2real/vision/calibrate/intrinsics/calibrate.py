"""A camera's intrinsics from photographs of a board (report B.1)."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.calibrate.intrinsics.case_deletion import delete_cases
from sim2real.vision.camera import CameraModel

FEWEST = 5  # photographs; a dozen, from all sides, is better
EDGE_ON = 75.0  # degrees of tilt, beyond which corners smear
UNSURE = 0.01  # of the focal length: greatest standard deviation of focal length and principal point
ROUGH = 1.0  # px, root mean square residual: more means that the board is another one, or not flat
CONTRADICTED = 2.5  # times the others' residuals: good photographs have up to 1.5, a mirrored board over 3


@dataclass(frozen=True)
class Intrinsics:
    """The result of a calibration with n photographs.

    std: (9,) standard deviations of fx, fy, cx, cy [pixels], k1, k2, p1, p2, k3; rms: (n,) of each photograph's
    residuals [pixels]; tilt: (n,) of its board [degrees]; off, others: (n,) residuals of the photograph and of the
    others if it is left out of the fit [pixels], see `CaseDeletion.deleted_rms`.
    """

    camera: CameraModel
    std: np.ndarray
    rms: np.ndarray
    tilt: np.ndarray
    off: np.ndarray
    others: np.ndarray

    @property
    def contradicted(self) -> np.ndarray:
        """Whether the other photographs contradict each one (n,)."""
        return self.off > CONTRADICTED * self.others


def calibrate(names: list[str], seen: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> Intrinsics:
    """Fit the intrinsics to the corners of boards.

    names: of the photographs, for errors; seen: for each, corners on the board (n, 3) [squares] and in the picture
    (n, 2) [pixels]; size: width and height of the photographs [pixels]. Raises ValueError, in one line, if the
    photographs are too few, do not show the board, or do not determine the intrinsics.
    """
    if len(seen) < FEWEST:
        raise ValueError(f"the board is seen in {len(seen)} photographs; expected {FEWEST} at least, better a dozen")
    _, k, distortion, turns, shifts, _, _, rms = _fit(seen, size)
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
    deletion = delete_cases(seen, k, distortion, motions)
    std = deletion.std()
    _check_sure(std, float(k[0, 0]), tilt)
    k1, k2, p1, p2, k3 = (float(one) for one in np.ravel(distortion)[:5])
    camera = CameraModel(float(k[0, 0]), float(k[1, 1]), float(k[0, 2]), float(k[1, 2]), (k1, k2, p1, p2, k3), size)
    return Intrinsics(camera, std, rms, tilt, *deletion.deleted_rms())


def _fit(seen: list[tuple[np.ndarray, np.ndarray]], size: tuple[int, int]) -> tuple:
    """The better of two fits by OpenCV: one starts at the focal length that OpenCV guesses from the boards'
    foreshortening, one at the picture's width. Either can end in a local minimum if the boards nearly face the camera.
    OpenCV runs on one thread, because several would sum in varying order and make the result irreproducible."""
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
    """Raise ValueError, in one line, if the photographs do not determine focal lengths and principal point."""
    unsure = std[:4] / focal
    if unsure.max() > UNSURE:
        what = "focal length" if unsure[:2].max() > UNSURE else "principal point"
        share = f"by {100 * unsure.max():.1f} %" if unsure.max() < 1.0 else "altogether"
        raise ValueError(
            f"the photographs do not determine the {what}: it is uncertain {share}, expected 1 % at most; tilts are "
            f"{tilt.min():.0f} to {tilt.max():.0f} degrees: take more with the board tilted by 20 to 45 degrees, this "
            "way and that"
        )


def _tilt(turn: np.ndarray) -> float:
    """The angle [degrees] between a board's normal and the camera's axis, of a rotation matrix (3, 3)."""
    return float(np.degrees(np.arccos(min(1.0, abs(turn[2, 2])))))
