"""ArUco markers in a photograph: OpenCV detects them, and their edges give the exact corners."""

from __future__ import annotations

import cv2
import numpy as np

from sim2real.vision.camera import CameraModel
from sim2real.vision.edges import refine
from sim2real.vision.photograph import smoothed

FEWEST = 3  # markers in a view at least
FAINT = 2.0  # grey levels between ink and paper at the table's far end, at the short exposure of play
STRETCH, BLURS = 4.0, (0.5, 1.0, 1.5)  # of a dim picture: factor of its grey levels; standard deviations [pixels]
BORDER = 2  # cells of a marker's black border, both sides together


def find_markers(image: np.ndarray, camera: CameraModel, dictionary: str) -> dict[int, np.ndarray]:
    """Find the markers of a dictionary in a photograph uint8 (rows, columns).

    Returns, by the marker's id, corners (4, 2) [pixels], clockwise from the marker's own top left. Raises ValueError,
    in one line, if fewer than three markers have clear edges.
    """
    even = smoothed(image)
    cells = dictionary_of(dictionary).markerSize + BORDER
    fine = {name: refine(even, camera, corners, cells) for name, corners in detect_markers(even, dictionary).items()}
    clear = {name: corners for name, corners in fine.items() if corners is not None}
    if len(clear) < FEWEST:
        raise ValueError(
            f"{len(clear)} of {len(fine)} markers have clear edges; expected {FEWEST} at least: mend focus, light, "
            "or a film's compression"
        )
    return clear


def detect_markers(even: np.ndarray, dictionary: str) -> dict[int, np.ndarray]:
    """Rough corners (4, 2) [pixels] by id of the markers in a smoothed photograph float64 (rows, columns). A dim one,
    in which too few are seen, is stretched and blurred more. Raises ValueError, in one line, if fewer than three are
    found."""
    book = dictionary_of(dictionary)
    coarse = np.rint(even).astype(np.uint8)
    detected = _detect(coarse, book)
    for blur in BLURS if len(detected) < FEWEST else ():
        dim = cv2.GaussianBlur(STRETCH * even, (0, 0), blur)
        detected = _detect(np.clip(np.rint(dim), 0.0, 255.0).astype(np.uint8), book, STRETCH * FAINT) | detected
    if len(detected) < FEWEST:
        raise ValueError(_too_few(coarse, dictionary, len(detected)))
    return detected


def dictionary_of(name: str) -> cv2.aruco.Dictionary:
    """OpenCV's dictionary of markers by its name, DICT_4X4_50 for example. Raises ValueError for an unknown name."""
    if name not in _dictionary_names():
        raise ValueError(f"unknown dictionary of markers '{name}'; expected one of OpenCV's, DICT_4X4_50 for example")
    return cv2.aruco.getPredefinedDictionary(getattr(cv2.aruco, name))


def _dictionary_names() -> list[str]:
    return [name for name in dir(cv2.aruco) if name.startswith("DICT_")]


def _detect(image: np.ndarray, book: cv2.aruco.Dictionary, faint: float = FAINT) -> dict[int, np.ndarray]:
    """Rough corners (4, 2) by id; faint: grey levels between ink and paper at least. An id that is seen twice is left
    out, because either could be the table's."""
    parameters = cv2.aruco.DetectorParameters()
    parameters.adaptiveThreshConstant = faint
    corners, ids, _ = cv2.aruco.ArucoDetector(book, parameters).detectMarkers(image)
    names = [] if ids is None else [int(one) for one in np.ravel(ids)]
    found = {name: one.reshape(4, 2).astype(float) for name, one in zip(names, corners, strict=True)}
    return {name: found[name] for name in sorted(found) if names.count(name) == 1}


def _too_few(image: np.ndarray, dictionary: str, many: int) -> str:
    """The error text for too few markers; it names another dictionary if more markers of that one are seen."""
    others = {name: len(_detect(image, dictionary_of(name))) for name in _dictionary_names()}
    best = max(others, key=lambda name: others[name])
    said = f"{many} markers of {dictionary} are seen; expected {FEWEST} at least"
    if others[best] >= max(FEWEST, many + 1):
        return f"{said}: {others[best]} of {best} are, so state that dictionary"
    return f"{said}: are they hidden, or out of the picture?"
