"""How a camera's noise differs over the table: far away, a pixel is wider.

The logarithm of the variance is linear in x and y. What polynomials leave of stretches of glides is distributed as a
gamma variable about it, so that its likelihood's maximum is a generalised linear model's (McCullagh and Nelder, 1989).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from sim2real.diagnose.glide.memory import ODD, Stretch, left_of

FRAMES = 40  # of a stretch
FEWEST = 12  # stretches, to tell
ROUNDS, STILL = 30, 1e-6
DOUBT = 1.0  # residuals' worth of a slope of nothing, for stretches that all lie at one place


def unevenness(glides: Sequence[Stretch], order: int) -> np.ndarray:
    """Logarithm of the variance in units of the assumed one: at the origin, and by x and by y [1/m]; zeros where there
    are too few glides to tell."""
    parts = [part for glide in glides for part in glide.cut(FRAMES)]
    if len(parts) < FEWEST:
        return np.zeros(3)
    squares, free = np.array([left_of(part, order)[:2] for part in parts]).T
    ratio = squares / free
    columns = np.stack([np.ones(len(parts)), *np.array([part.place.mean(axis=0) for part in parts]).T], axis=1)
    told = np.array([np.log(np.median(ratio)), 0.0, 0.0])
    penalty = np.diag([0.0, DOUBT, DOUBT])
    for _ in range(ROUNDS):  # Fisher's scoring: the information of a gamma variable's logarithm is its shape
        over = ratio / np.exp(columns @ told) - 1.0
        weight = 0.5 * free * (over < ODD - 1.0)  # where a hand pushed, there is more than noise
        step = np.linalg.solve((columns.T * weight) @ columns + penalty, columns.T @ (weight * over) - penalty @ told)
        told = told + step
        if np.abs(step).max() < STILL:
            break
    return told


def uneven(place: np.ndarray, told: np.ndarray) -> np.ndarray:
    """How much larger (n, 1) the deviation is at places (n, 2)."""
    return np.exp(0.5 * (told[0] + place @ told[1:]))[:, None]
