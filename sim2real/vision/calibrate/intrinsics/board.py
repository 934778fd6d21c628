"""Boards for the camera's intrinsics: a checkerboard or a ChArUco board, found in photographs."""

from __future__ import annotations

from dataclasses import dataclass

import cv2
import numpy as np

from sim2real.vision.markers import dictionary_of

FEWEST = 12  # corners of a ChArUco board, which may be partly hidden


@dataclass(frozen=True)
class CalibrationBoard:
    """A checkerboard with `columns` by `rows` inner corners, or with a `dictionary` a ChArUco board whose markers are
    `marker` squares wide. Lengths are in squares, because intrinsics do not depend on the squares' size."""

    columns: int
    rows: int
    dictionary: str | None = None
    marker: float = 0.75

    def find(self, image: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
        """Find the board in a picture uint8 (rows, columns): corners on the board (n, 3) [squares] and in the picture
        (n, 2) [pixels]; None if it is not found."""
        if self.dictionary is None:
            flags = cv2.CALIB_CB_ACCURACY | cv2.CALIB_CB_NORMALIZE_IMAGE
            found, corners = cv2.findChessboardCornersSB(image, (self.columns, self.rows), flags=flags)
            every = np.arange(self.columns * self.rows)
            return self._pair(every, corners) if found else None
        size, dictionary = (self.columns + 1, self.rows + 1), dictionary_of(self.dictionary)
        board = cv2.aruco.CharucoBoard(size, 1.0, self.marker, dictionary)
        corners, ids, _, _ = cv2.aruco.CharucoDetector(board).detectBoard(image)
        return None if ids is None or len(ids) < FEWEST else self._pair(np.ravel(ids), corners)

    def _pair(self, ids: np.ndarray, corners: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        places = np.column_stack([ids % self.columns, ids // self.columns, np.zeros(len(ids))])
        return places.astype(np.float32), np.asarray(corners, np.float32).reshape(-1, 2)
