"""Rigid motions (SE(3)) as six numbers, a rotation vector [rad] and a shift [m], with derivatives."""

from __future__ import annotations

import numpy as np


def cross_matrix(vectors: np.ndarray) -> np.ndarray:
    """Skew-symmetric matrices (..., 3, 3) of vectors v (..., 3): their product with w is the cross product of v and
    w."""
    x, y, z = np.moveaxis(vectors, -1, 0)
    o = np.zeros_like(x)
    return np.stack([o, -z, y, z, o, -x, -y, x, o], axis=-1).reshape(*vectors.shape[:-1], 3, 3)


def rotation(vector: np.ndarray) -> np.ndarray:
    """The rotation matrix (3, 3) of a rotation vector (3,) [rad], by Rodrigues' formula."""
    a, b, _ = _series(float(np.linalg.norm(vector)))
    k = cross_matrix(vector)
    return np.eye(3) + a * k + b * k @ k


def apply_motion(motion: np.ndarray, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Rotate, then shift points (n, 3) [m] by a motion (6,).

    Returns the points (n, 3) [m], their derivatives (n, 3, 6) by the motion, and the rotation matrix (3, 3), which is
    the derivative by the points.
    """
    turn = rotation(motion[:3])
    _, b, c = _series(float(np.linalg.norm(motion[:3])))
    k = cross_matrix(motion[:3])
    right = np.eye(3) - b * k + c * k @ k  # the right Jacobian of SO(3) (Chirikjian 2011)
    by_turn = -turn @ cross_matrix(points) @ right
    by_shift = np.broadcast_to(np.eye(3), by_turn.shape)
    return points @ turn.T + motion[3:], np.concatenate([by_turn, by_shift], axis=2), turn


def _series(angle: float) -> tuple[float, float, float]:
    """sin(t)/t, (1 - cos(t))/t^2 and (t - sin(t))/t^3 of an angle t [rad], by Taylor series where it is small."""
    if angle < 1e-3:
        return 1.0 - angle**2 / 6.0, 0.5 - angle**2 / 24.0, 1.0 / 6.0 - angle**2 / 120.0
    return (
        float(np.sin(angle)) / angle,
        float(1.0 - np.cos(angle)) / angle**2,
        (angle - float(np.sin(angle))) / angle**3,
    )
