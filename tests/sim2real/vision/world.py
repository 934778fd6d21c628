"""A made-up table as an independent oracle: exact pixels by cv2.projectPoints, photographs by tracing rays."""

from __future__ import annotations

import json
from pathlib import Path

import cv2
import numpy as np

K = np.array([[1640.0, 0.0, 1018.0], [0.0, 1639.0, 772.0], [0.0, 0.0, 1.0]])
DISTORTION = np.array([-0.128, 0.155, 0.0012, -0.00017, -0.065])
SIZE = (2048, 1536)
LENGTH, WIDTH, TOP, SIDE = 2.0, 1.0, 0.006, 0.08
CURVATURE = (0.004, -0.002, -0.008)  # 1/m, about the middle
CAMERA_PLACES = ((-0.55, 0.5, 1.6), (-0.35, 0.15, 1.75), (-0.45, 0.85, 1.7), (-0.6, 0.6, 1.8))
LOOK = (0.9, 0.5, 0.0)
SAMPLES = 5  # a pixel's width of rays
MARGIN = 1  # cells of white round a marker


def camera_motion(place: tuple[float, float, float]) -> np.ndarray:
    """Rotation vector and shift (6,) of a camera at `place` [m] that looks at the table; the image's top shows its far
    end."""
    ahead = np.subtract(LOOK, place)
    ahead /= np.linalg.norm(ahead)
    right = np.cross(ahead, [0.0, 0.0, 1.0])
    right /= np.linalg.norm(right)
    turn = np.stack([right, np.cross(ahead, right), ahead])
    return np.concatenate([cv2.Rodrigues(turn)[0].ravel(), -turn @ place])


def height(places: np.ndarray) -> np.ndarray:
    x, y = (places - [LENGTH / 2, WIDTH / 2]).T
    return CURVATURE[0] * x * x + CURVATURE[1] * x * y + CURVATURE[2] * y * y


def seen(motion: np.ndarray, points: np.ndarray) -> np.ndarray:
    """Pixels (n, 2) of points (n, 3), by OpenCV."""
    return cv2.projectPoints(points, motion[:3], motion[3:], K, DISTORTION)[0][:, 0]


def puck_points(places: np.ndarray) -> np.ndarray:
    return np.column_stack([places, height(places) + TOP])


def grid() -> np.ndarray:
    """36 places (36, 2) over the table."""
    x, y = np.meshgrid(np.linspace(0.12, 1.88, 6), [0.05, 0.25, 0.42, 0.58, 0.75, 0.95], indexing="ij")
    return np.stack([x.ravel(), y.ravel()], axis=1)


def markers() -> dict[int, np.ndarray]:
    """Corners (4, 3) of six markers beside the table, somewhat tilted and raised."""
    found = {}
    for k, (x, y) in enumerate([(x, y) for y in (-0.09, 1.09) for x in (0.3, 1.05, 1.8)]):
        turn = cv2.Rodrigues(np.array([0.02 * k - 0.05, 0.04 - 0.015 * k, -1.5 + 0.05 * k]))[0]
        square = 0.5 * SIDE * np.array([[-1.0, 1, 0], [1, 1, 0], [1, -1, 0], [-1, -1, 0]])
        found[k] = square @ turn.T + (x, y, 0.01 + 0.002 * k)
    return found


def photograph(
    motion: np.ndarray, blur: float = 0.7, noise: float = 2.0, book: int = cv2.aruco.DICT_4X4_50
) -> np.ndarray:
    """The markers on a grey ground (1536, 2048) uint8, each pixel the mean of many rays, then blurred and noisy."""
    image = np.full(SIZE[::-1], 90.0)
    turn = cv2.Rodrigues(motion[:3])[0]
    dictionary = cv2.aruco.getPredefinedDictionary(book)
    cells = dictionary.markerSize + 2
    for k, corners in markers().items():
        pattern = cv2.aruco.generateImageMarker(dictionary, k, cells)
        pattern = np.where(np.pad(pattern, MARGIN, constant_values=255) > 127, 220.0, 30.0)
        pattern = np.pad(pattern, 1, constant_values=90.0)
        pixels = seen(motion, corners)
        middle, reach = pixels.mean(axis=0), 1.9 * np.abs(pixels - pixels.mean(axis=0)).max() + 3
        low = np.maximum(np.floor(middle - reach), 0).astype(int)
        high = np.minimum(np.ceil(middle + reach), np.array(SIZE) - 1).astype(int)
        steps = (np.arange(SAMPLES) + 0.5) / SAMPLES - 0.5
        u = (np.arange(low[0], high[0])[:, None] + steps).ravel()
        v = (np.arange(low[1], high[1])[:, None] + steps).ravel()
        rays = cv2.undistortPoints(np.stack(np.meshgrid(u, v), axis=-1).reshape(-1, 1, 2), K, DISTORTION,
                                   criteria=(3, 40, 1e-12))[:, 0]  # fmt: skip
        right, down = (corners[1] - corners[0]) / SIDE, (corners[3] - corners[0]) / SIDE
        plane = turn @ np.stack([right, down, corners[0]], axis=1)
        plane[:, 2] += motion[3:]
        at = np.column_stack([rays, np.ones(len(rays))]) @ np.linalg.inv(plane).T
        cell = np.floor(at[:, :2] / at[:, 2:] / SIDE * cells).astype(int) + MARGIN + 1
        column, row = np.clip(cell, 0, len(pattern) - 1).T
        fine = pattern[row, column].reshape(len(v) // SAMPLES, SAMPLES, len(u) // SAMPLES, SAMPLES)
        image[low[1] : high[1], low[0] : high[0]] = fine.mean(axis=(1, 3))
    image = cv2.GaussianBlur(image, (0, 0), blur) + np.random.default_rng(7).normal(0.0, noise, image.shape)
    return np.clip(np.rint(image), 0, 255).astype(np.uint8)


def camera_fields() -> dict:
    return {
        "K": K.tolist(),
        "distortion_k1_k2_p1_p2_k3": DISTORTION.tolist(),
        "aruco_dictionary": "DICT_4X4_50",
        "puck_top_above_table_m": TOP,
        "table": {"length_m": LENGTH, "width_m": WIDTH, "goal_width_m": None},
    }


def write_view(folder: Path, image: np.ndarray, pixels: np.ndarray, places: np.ndarray) -> Path:
    folder.mkdir(parents=True)
    cv2.imwrite(str(folder / "view.png"), image)
    rows = np.column_stack([pixels, places])
    np.savetxt(folder / "pixels.csv", rows, delimiter=",", header="u,v,x,y", comments="", fmt="%.6f")
    return folder


def write_camera_file(path: Path) -> Path:
    path.write_text(json.dumps(camera_fields()))
    return path
