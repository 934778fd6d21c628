"""Wall contacts of a puck whose spin is not known: what they say of friction is not what their noise shares with it."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.regimes.wall.data import WallContacts
from sim2real.diagnose.regimes.wall.problem import WallProblem

COUNT, SIGMA = 150, 3e-4  # contacts; noise of a velocity [m/s]
MU, KAPPA, RESTITUTION, RADIUS = 0.3, 0.5, 0.7, 0.0309
DEFAULTS = {row.name: row.default for row in TABLE} | {"puck_radius": RADIUS, "spin_decay": 0.0}
LAW = {"wall_mu": MU, "spin_inertia": KAPPA, "wall_restitution": RESTITUTION, "spin_decay": 0.0}


def contacts(known: int, correlation: float) -> WallProblem:
    """Contacts with the wall y0 in play: of `known` the puck did not spin before, of the others it did, by 20 rad/s and
    more; the noise of normal and tangent has this `correlation`."""
    rng = np.random.default_rng(4)
    closing, along = rng.uniform(0.5, 4.0, COUNT), rng.uniform(-3.0, 3.0, COUNT)
    spin = np.where(np.arange(COUNT) < known, 0.0, rng.normal(0.0, 40.0, COUNT) + 20.0 * np.sign(along))
    slip = along - RADIUS * spin  # Stronge, Impact Mechanics, ch. 3: a disc of inertia kappa m r^2
    rubbed = np.clip(-slip / (1.0 + 1.0 / KAPPA), *(np.outer([-1.0, 1.0], MU * (1.0 + RESTITUTION) * closing)))
    covariance = SIGMA**2 * np.array([[1.0, correlation], [correlation, 1.0]])
    noise = rng.multivariate_normal([0.0, 0.0], covariance, COUNT)
    after = np.stack([along + rubbed, RESTITUTION * closing], axis=1) + noise
    covariances = np.zeros((COUNT, 2, 2, 2))
    covariances[:, 1] = covariance[::-1, ::-1]
    data = WallContacts(
        kind=np.full(COUNT, bounce.WALL_Y0), normal=np.tile([0.0, 1.0], (COUNT, 1)), t=np.arange(COUNT, dtype=float),
        velocity_before=np.stack([along, -closing], axis=1), velocity_after=after, velocity_covariance=covariances,
        place=np.stack([rng.uniform(0.2, 1.8, COUNT), np.full(COUNT, 0.03)], axis=1),
        common_errors=np.zeros((COUNT, 2, 2, 0)), normal_std=np.zeros(COUNT), spin_chain=np.arange(COUNT),
        spin_unknown=np.arange(COUNT) >= known, time_since_contact=np.full(COUNT, np.nan), cluster=np.arange(COUNT),
    )  # fmt: skip
    return WallProblem(data, COUNT, DEFAULTS)


@pytest.mark.parametrize("correlation", [-0.05, 0.0, 0.05])
@pytest.mark.parametrize("known", [0, 12])
def test_unknown_spins_neither_bias_friction_nor_seem_to_measure_it(known: int, correlation: float) -> None:
    problem = contacts(known, correlation)
    at_truth = problem.residuals(LAW, (), np.arange(COUNT)).r
    assert float(at_truth @ at_truth) < 1.3 * 2 * COUNT
    found = fit(problem, LAW, ("wall_restitution", "wall_mu", "spin_inertia"), np.arange(COUNT))
    off = abs(found.values["spin_inertia"] - KAPPA) / np.sqrt(found.covariance[2, 2])
    assert off < 3.0 and found.values["wall_restitution"] == pytest.approx(RESTITUTION, abs=0.001)
