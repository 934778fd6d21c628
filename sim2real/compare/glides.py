"""Compare glides with the simulator: the predicted path from a start fitted to the first part of the glide."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.sliding import glide
from sim2real.compare.map_error import MapError
from sim2real.compare.tuned import COMPARISON
from sim2real.diagnose.regimes.sliding.trajectory import trace
from sim2real.segmentation.segments import Glide
from sim2real.segmentation.sensor_noise import MotionNoise
from sim2real.statistics.whitening import decorrelated

ROUNDS = 4  # of Gauss-Newton


@dataclass(frozen=True)
class GlideError:
    """A glide and its prediction, from a start fitted to its first `fitted` frames with the same law.

    `begins` [s]: the start, on the camera's clock; `t` (n,) [s] since then; `x`, `y` (n,) [m] recorded; `path` (n, 2)
    [m] predicted; `error` (n, 2) [m] along and across the motion, recorded minus predicted; `std` (n, 2) [m]: its
    standard deviation due to noise and calibration error, including the error of the fitted start; `speed` [m/s] at the
    start.
    """

    begins: float
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    path: np.ndarray
    error: np.ndarray
    std: np.ndarray
    fitted: int
    speed: float


def why_not_usable(segment: Glide) -> str:
    """The reason why a glide cannot be compared; "" if it can."""
    if len(segment.t) < COMPARISON.fewest_frames:
        return f"shorter than {COMPARISON.fewest_frames} frames"
    speed = float(np.hypot(segment.x[-1] - segment.x[0], segment.y[-1] - segment.y[0])) / (segment.t[-1] - segment.t[0])
    return f"slower than {COMPARISON.slowest} m/s" if speed < COMPARISON.slowest else ""


def predict_glide(segment: Glide, noise: MotionNoise, map_error: MapError, p: np.void) -> GlideError:
    """Fit place and velocity of the start to the first part of the glide, then predict to its end.

    `p`: the simulator's parameters, with those of effects: the puck slides as in the simulator, without spin.
    """
    t, place = segment.t - segment.t[0], np.stack([segment.x, segment.y], axis=1)
    fitted = max(COMPARISON.fewest_fitted, int(COMPARISON.fitted_part * len(t)))
    p0, v0 = segment.entry.place, segment.entry.velocity
    correlation = noise.correlation(t)
    for _ in range(ROUNDS):
        path, axes, slopes = _law(segment.t, p0, v0, p)
        rest = (place - path) @ axes
        weights = [_weights(slopes[:fitted, k], correlation) for k in (0, 1)]
        solved = [weights[k] @ rest[:fitted, k] for k in (0, 1)]
        p0 = p0 + axes @ [solved[0][0], solved[1][0]]
        v0 = v0 + axes @ [solved[0][1], solved[1][1]]
    path, axes, slopes = _law(segment.t, p0, v0, p)
    speed = float(np.linalg.norm(v0))
    sigma = noise.std(np.array([speed, 0.0]))
    by_map = np.einsum("nim,ik->nkm", map_error.of_places(place), axes)
    std = np.stack([_spread(slopes[:, k], fitted, sigma[k], correlation, by_map[:, k]) for k in (0, 1)], axis=1)
    begins = float(segment.t[0])
    return GlideError(begins, t, segment.x, segment.y, path, (place - path) @ axes, std, fitted, speed)


def _law(t: np.ndarray, p0: np.ndarray, v0: np.ndarray, p: np.void) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Simulate the path (n, 2) [m]; return it, its axes (2, 2), along and across in columns, and its derivatives (n, 2)
    [s] along and across by the start's velocity along and across. Derivatives by the start's place are 1. The
    derivatives are those without effects, which change little in the part that is fitted."""
    speed = max(float(np.linalg.norm(v0)), 1e-6)
    along = v0 / speed
    step = 1e-4 * speed
    path = np.empty((len(t), 4))
    trace(p, np.array([0, len(t)]), t, np.array([[*p0, *v0, 0.0]]), np.zeros(1, PUCK), path)
    friction, drag = float(p["friction"]), float(p["drag"])
    s, faster = (
        np.array([glide.distance(v, float(at - t[0]), friction, drag) for at in t]) for v in (speed, speed + step)
    )
    axes = np.stack([along, [-along[1], along[0]]], axis=1)
    return path[:, :2], axes, np.stack([(faster - s) / step, s / speed], axis=1)


def _design(slope: np.ndarray) -> np.ndarray:
    return np.stack([np.ones_like(slope), slope], axis=1)


def _weights(slope: np.ndarray, correlation: np.ndarray) -> np.ndarray:
    """Weights (2, f) of the generalized least-squares fit of a start's place and velocity to the first f frames.

    `slope` (f,) [s]: derivatives of these frames by the velocity; `correlation` (n, n): of all frames' noise.
    """
    fitted = len(slope)
    rows = decorrelated(correlation[:fitted, :fitted], np.column_stack([_design(slope), np.eye(fitted)]))
    return np.linalg.pinv(rows[:, :2]) @ rows[:, 2:]


def _spread(slope: np.ndarray, fitted: int, sigma: float, correlation: np.ndarray, by_map: np.ndarray) -> np.ndarray:
    """Standard deviation (n,) [m] of recorded minus predicted, for a start fitted to the first `fitted` frames.

    `sigma` [m]: of the noise of each frame, with this `correlation` (n, n); `by_map` (n, m) [m]: deviations due to the
    map error, which the fitted start absorbs in part.
    """
    remaining = np.eye(len(slope))
    remaining[:, :fitted] -= _design(slope) @ _weights(slope[:fitted], correlation)
    noise = np.sum((remaining @ correlation) * remaining, axis=1)
    rest = remaining @ by_map
    return np.sqrt(sigma**2 * np.maximum(noise, 0.01) + (rest**2).sum(axis=1))
