"""A mallet that goes to and fro by a formula, its encoders, and a camera with a clock of its own."""

from __future__ import annotations

import numpy as np

TIMES = (0.25, 0.4, 0.6)  # s of strokes, one after the other
REACH = 0.3  # m


def place(t: np.ndarray) -> np.ndarray:
    """The mallet's place (n, 2) [m] at times (n,) [s]: minimum-jerk strokes, x and y at different paces."""
    x, y = (_to_and_fro(t, pace) for pace in (1.0, 1.37))
    return np.column_stack([0.2 + REACH * x, 0.35 + REACH * y])


def _to_and_fro(t: np.ndarray, pace: float) -> np.ndarray:
    ends = np.cumsum(np.tile(np.repeat(TIMES, 2), 200)) * pace
    which = np.searchsorted(ends, t, side="right")
    begin = np.append(0.0, ends)[which]
    share = (t - begin) / (ends[which] - begin)
    done = share**3 * (10.0 - 15.0 * share + 6.0 * share**2)  # Flash and Hogan, J. Neurosci. 5, 1985
    return np.where(which % 2 == 0, done, 1.0 - done)


def encoders(seconds: float) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) [s] and places (n, 2) [m] to the encoders' quantum."""
    t = np.arange(0.0, seconds, 0.002)
    return t, np.round(place(t) / 8e-6) * 8e-6


def frames(
    seconds: float, delay: float, drift: float, noise: np.ndarray, map_error: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Stamps (m,) [s] and places (m, 2) [m] of frames exposed at 120 Hz.

    delay [s], drift [1]: of the stamps; noise (m, 2) [m]; map_error: by which the camera's map is stretched, sheared
    and shifted.
    """
    exposed = np.arange(0.1, seconds - 0.1, 1.0 / 120.0)
    matrix = np.array([[1.0 + map_error, 0.5 * map_error], [-map_error, 1.0 - map_error]])
    return (1.0 + drift) * exposed + delay, place(exposed) @ matrix + map_error + noise[: len(exposed)]


def correlated_noise(random: np.random.Generator, size: float, correlation: float) -> np.ndarray:
    """Noise (6000, 2) [m] of standard deviation `size`, with this correlation from frame to frame."""
    steps = random.standard_normal((6000, 2)) * np.sqrt(1.0 - correlation**2)
    found = np.empty_like(steps)
    found[0] = random.standard_normal(2)
    for k in range(1, len(steps)):
        found[k] = correlation * found[k - 1] + steps[k]
    return size * found
