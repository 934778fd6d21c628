"""Residuals of glides depend only on their law, not on earlier calls, and the fitted starts are optimal."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.engine.least_squares import given
from sim2real.diagnose.regimes.sliding.data import GlideData
from sim2real.diagnose.regimes.sliding.problem import GlideProblem

TABLE = {"length": 2.0, "width": 1.0}
NEAR = {"friction": 0.1, "drag": 0.1}
FAR = {"friction": 1.0, "drag": 2.0, "tilt_x": 0.3, "side_force": -1.0}
FREE = ("friction", "drag", "tilt_y")
USUAL = {"friction": 0.15, "drag": 0.3, "tilt_x": 0.03}
GLIDES, FRAMES = 6, 150


def problem() -> GlideProblem:
    """Glides of a second at 0.3 to 1.8 m/s that brake by 0.1 m/s^2, with noise of 0.2 mm."""
    rng = np.random.default_rng(4)
    u = np.arange(FRAMES) / FRAMES
    places = []
    for speed in np.linspace(0.3, 1.8, GLIDES):
        heading = rng.uniform(0.0, 2.0 * np.pi)
        path = 0.5 + (speed * u - 0.05 * u**2)[:, None] * [np.cos(heading), np.sin(heading)]
        places.append(path + rng.normal(0.0, 2e-4, path.shape))
    glides = np.arange(GLIDES)
    return GlideProblem(
        GlideData(
            np.concatenate([2.0 * k + u for k in glides]), np.concatenate(places), np.full((GLIDES * FRAMES, 2), 2e-4),
            FRAMES * np.arange(GLIDES + 1), glides, 0 * glides, np.full(GLIDES, np.nan),
        ),
        TABLE,
    )  # fmt: skip


def answers(problem: GlideProblem, law: dict[str, float]) -> list[np.ndarray]:
    residuals = problem.residuals(law, FREE, np.arange(GLIDES))
    states = problem.states(given(law))
    return [residuals.r, residuals.jacobian, states.motion, states.spread, *problem.linearized(law)]


def test_the_same_law_has_the_same_residuals_whatever_was_computed_before() -> None:
    one, other = problem(), problem()
    near, far = answers(one, NEAR), answers(one, FAR)
    far_first, near_last = answers(other, FAR), answers(other, NEAR)
    for expected, found in zip([*near, *far, *near], [*near_last, *far_first, *answers(one, NEAR)], strict=True):
        np.testing.assert_array_equal(found, expected)


@pytest.mark.parametrize("law", [NEAR, USUAL])
def test_no_small_change_of_a_start_lowers_the_residuals(law: dict[str, float]) -> None:
    some = problem()
    path, by_start = some.linearized(law)
    slopes = np.einsum("nai,na->ni", some.errors.white(by_start), some.errors.white(some.data.place - path[:, :2]))
    of_glide = np.add.reduceat(slopes, some.data.first[:-1], axis=0)
    sizes = np.sqrt(np.add.reduceat((some.errors.white(by_start) ** 2).sum(axis=1), some.data.first[:-1], axis=0))
    assert np.abs(of_glide / sizes).max() < 0.01  # standard deviations of the start
