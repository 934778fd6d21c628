"""The shear of a map by bounces off the long walls: estimated where no short wall was met, told from turned walls."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.bounce_angles import bounce_angles
from sim2real.diagnose.regimes.sensing.contact_lines import contact_lines
from sim2real.diagnose.regimes.sensing.coordinate_scale import distances_of_others, fitted_map, identify_scale
from sim2real.segmentation.causes import Geometry
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.velocity_jumps import VelocityJump

TABLE = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
STD = np.array([1e-4, 3e-4, 3e-4, 0.01, 0.01, 0.01, 0.01])


def bounces(shear: float, turned: dict[str, float], friction: float, seed: int = 3) -> list[VelocityJump]:
    """Fourteen bounces off each long wall, seen through a map with a `shear`: x + shear y for x.

    A wall that is `turned` [rad] mirrors the velocity in its own normal; its `friction` takes a share of the velocity
    along it.
    """
    rng, found = np.random.default_rng(seed), []
    for wall, inward, y in (("y0", 1.0, 0.03), ("y1", -1.0, 0.97)):
        angle = turned.get(wall, 0.0)
        normal, along = inward * np.array([-np.sin(angle), np.cos(angle)]), np.array([np.cos(angle), np.sin(angle)])
        for _ in range(14):
            before = np.array([rng.uniform(-1.5, 1.5), -inward * rng.uniform(1.0, 3.0)])
            after = -0.8 * (before @ normal) * normal + (1.0 - friction) * (before @ along) * along
            x = rng.uniform(0.1, 1.9)
            places = [np.array([x, y + (x - 1.0) * np.tan(angle)]), before, after]
            seen = [np.array([one[0] + shear * one[1], one[1]]) for one in places]
            state = np.concatenate([[len(found)], *seen]) + rng.normal(0.0, STD)
            v_in, v_out = state[3:5], state[5:7]
            t, *at = state[:3]
            event = ContactEvent("wall", wall, t, at[0], at[1], v_in, v_out, 0.01, (0, 1), 9.0, True)
            found.append(VelocityJump(event, state, np.diag(STD**2), len(found) // 2))
    return found


@pytest.mark.parametrize("friction", [0.0, 0.25])
@pytest.mark.parametrize("shear", [0.006, -0.012])
def test_a_shear_is_seen_at_the_long_walls(shear: float, friction: float) -> None:
    values, covariance = fitted_map(bounces(shear, {}, friction), TABLE)
    assert values[2] == pytest.approx(shear, abs=4 * np.sqrt(covariance[2, 2]))
    assert np.sqrt(covariance[2, 2]) < 0.0015
    result = identify_scale(bounces(shear, {}, friction), TABLE)
    assert result.values[2] == pytest.approx(values[2])
    assert result.values[0] == 0.0  # no short wall was met


@pytest.mark.parametrize("friction", [0.0, 0.5])
def test_friction_takes_no_part_of_the_shear(friction: float) -> None:
    """Friction acts on the velocity along the wall, of which the map shows too much."""
    found = [fitted_map(bounces(0.012, {}, friction, seed), TABLE) for seed in range(12)]
    values = np.array([one[2] for one, _ in found])
    stds = np.sqrt([covariance[2, 2] for _, covariance in found])
    assert values.mean() == pytest.approx(0.012, abs=3 * 0.0009 / np.sqrt(12))
    assert np.abs((values - 0.012) / stds).max() < 3.0
    assert 0.6 < values.std() / stds.mean() < 1.5


def test_no_shear_is_named_where_none_is() -> None:
    for seed in range(12):
        assert not identify_scale(bounces(0.0, {}, 0.2, seed), TABLE).findings


def test_turned_walls_are_no_shear() -> None:
    opposite = bounces(0.0, {"y0": 0.004, "y1": -0.004}, 0.1)
    assert bounce_angles(contact_lines(opposite, TABLE)).walls == ()
    alike = bounces(0.0, {"y0": 0.004, "y1": 0.004}, 0.1)
    assert bounce_angles(contact_lines(alike, TABLE)).values == pytest.approx([-0.004, -0.004], abs=0.003)
    assert not identify_scale(alike, TABLE).findings, "a turned map, whose lines are slanted too"


def test_the_correction_is_judged_by_bounces_of_others() -> None:
    others = distances_of_others(bounces(0.012, {}, 0.1, seed=8), np.array([0.0, 0.0, 0.012]), TABLE)
    before, after, std = others[:, 0], others[:, 1], others[:, 2]
    assert np.sqrt(np.mean((after / std) ** 2)) < 1.2
    assert np.sqrt(np.mean((before / std) ** 2)) > 1.5
