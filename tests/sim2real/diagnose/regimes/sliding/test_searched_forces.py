"""Spans, pulses and waves are found where they are, and a name makes the same force again."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.engine.linear.rest import Rest, gains_of_groups
from sim2real.diagnose.regimes.sliding.forces.force_search import ForceSearch, Steps, searched_forces
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.forces.patch_search import _distinct
from sim2real.diagnose.regimes.sliding.forces.searched_forces import Span, Wave, searched_force

FORCES = [
    Span("brake", "x", 0.6213, 0.8127), Span("push", "t", 12.4, 25.75), Span("brake", "t", 0.7, 2.2, 6.1), Wave(6.37),
    Span("push", "y", 0.1, 0.33),
]  # fmt: skip


def motion(n: int = 6000) -> Motion:
    """A minute of places and velocities drawn at random, in order of time."""
    rng = np.random.default_rng(3)
    place, velocity = rng.uniform(0.0, 1.0, (n, 2)) * (2.0, 1.0), rng.normal(0.0, 1.0, (n, 2))
    t, none = np.sort(rng.uniform(0.0, 60.0, n)), np.zeros(n)
    return Motion(t, place, velocity, none, none, none, np.array([2.0, 1.0]), np.linspace(0.1, 2.5, 6))


def as_rows(force: np.ndarray) -> np.ndarray:
    """Forces (n, 2, k) as if each residual showed its own instant's (2n, k)."""
    return force.reshape(-1, force.shape[2])


@pytest.mark.parametrize("force", [*FORCES, Wave(12.0)])
def test_a_name_makes_the_force_again(force: Span | Wave) -> None:
    assert searched_force(force.name) == force


@pytest.mark.parametrize("name", ["brake by position", "brake by a wave in time", "push from z = 0 m to 1 m", ""])
def test_other_names_are_none_of_these(name: str) -> None:
    assert searched_force(name) is None


@pytest.mark.parametrize("true", FORCES, ids=lambda one: one.name)
def test_a_force_is_found_where_it_is(true: Span | Wave) -> None:
    m = motion()
    columns = 20.0 * as_rows(true.force(m))
    noise = np.random.default_rng(4).normal(0.0, 0.3 * columns.std(), len(columns))
    rest = Rest.of(columns @ np.ones(columns.shape[1]) + noise, as_rows(-m.along[:, :, None]))
    used = np.ones(len(columns), bool)
    found = [one.force for one in searched_forces(m, as_rows, [rest], used)]
    if isinstance(true, Wave):
        waves = [one for one in found if isinstance(one, Wave)]
        assert [one.period for one in waves] == pytest.approx([true.period], rel=2e-3)
        return
    alike = [one for one in found if isinstance(one, Span) and (one.kind, one.of) == (true.kind, true.of)]
    near = [one for one in alike if bool(one.every) == bool(true.every)]
    unit = 1.0 if true.of == "t" else 0.05
    shapes = [(one.low, one.high, one.every) for one in near]
    assert any(np.allclose(one, (true.low, true.high, true.every), atol=0.1 * unit) for one in shapes), shapes


def test_noise_alone_is_hardly_searched() -> None:
    m = motion()
    rest = Rest.of(np.random.default_rng(5).normal(size=2 * len(m.t)), as_rows(-m.along[:, :, None]))
    assert len(list(searched_forces(m, as_rows, [rest], np.ones(2 * len(m.t), bool)))) <= 2


def test_steps_give_the_gain_of_each_span_between_two() -> None:
    m = motion(600)
    r = np.random.default_rng(6).normal(size=1200)
    rest, used = Rest.of(r, as_rows(-m.along[:, :, None])), np.ones(1200, bool)
    steps = Steps.of(m, as_rows, used, "push", "x")
    for first, last in ((0, 5), (7, 30), (20, len(steps.at) - 1)):
        block = as_rows(Span("push", "x", float(steps.at[first]), float(steps.at[last])).force(m))
        alone = block - rest.basis @ (rest.basis.T @ block)
        wanted = np.sum((alone @ np.linalg.lstsq(alone, rest.r, rcond=None)[0]) ** 2)
        assert steps.gains(rest, np.array([first]), np.array([last])) == pytest.approx([wanted], rel=1e-6)
        normal, right = rest.normal(block)
        assert gains_of_groups(normal[None], right[None]) == pytest.approx([wanted], rel=1e-6)


def test_a_search_without_rows_that_are_used_is_of_those_that_are() -> None:
    """Residuals that are not used change nothing."""
    m, rows = motion(), np.repeat(np.arange(6000) % 3 > 0, 2)
    true = FORCES[0].force(m)
    r = 20.0 * as_rows(true) @ np.ones(1)
    found = []
    for other in (0.0, 5.0):
        spoiled = np.where(rows, r, other)
        rest = Rest.of(spoiled[rows], as_rows(-m.along[:, :, None])[rows])
        steps = Steps.of(m, as_rows, rows, "brake", "x")
        found.append([one.force for one in ForceSearch(m, as_rows, rest, rows).spans("brake", "x", steps)])
    assert found[0] == found[1] != []


def test_no_patch_that_is_offered_has_its_middle_in_another() -> None:
    """The two best overlap; the third is elsewhere."""
    discs = np.array([[0.4, 0.7, 0.5], [0.45, 0.7, 0.5], [1.4, 0.5, 0.45], [1.5, 0.5, 0.3]])
    kept = _distinct(discs, np.array([8.0, 10.0, 7.0, 5.0]))
    np.testing.assert_array_equal(kept, discs[[1, 2]])
