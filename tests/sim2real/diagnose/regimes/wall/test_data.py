"""Selection of wall contacts, spin chains between them, and the wave that they show."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.engine.candidate_models import identifiable
from sim2real.diagnose.regimes.contact.data import select_contacts
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts, is_usual, split_spin_chains, wall_contacts
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.segmentation.causes import Geometry

COUNT, LAUNCHES, NOISE = 80, 20, 0.001
DEFAULTS = {row.name: row.default for row in TABLE}


def contacts_that_keep(restitution, kind: np.ndarray | None = None, wrong: int = 0) -> WallContacts:
    """Contacts with the wall y0 (or `kind`) that keep `restitution(x)` of both components at x [m]; `wrong` of them a
    quarter less. All share one common error."""
    rng = np.random.default_rng(5)
    closing, along = rng.uniform(0.4, 3.0, COUNT), rng.uniform(-2.0, 2.0, COUNT)
    x = rng.uniform(0.1, 1.9, COUNT)
    share = restitution(x)
    share[rng.choice(COUNT, wrong, replace=False)] -= 0.25
    before = np.stack([along, -closing], axis=1)
    after = share[:, None] * np.stack([along, closing], axis=1) + rng.normal(0.0, NOISE, (COUNT, 2))
    return WallContacts(
        kind=np.full(COUNT, bounce.WALL_Y0) if kind is None else kind, normal=np.tile([0.0, 1.0], (COUNT, 1)),
        t=np.arange(COUNT, dtype=float), velocity_before=before, velocity_after=after,
        place=np.stack([x, np.full(COUNT, 0.03)], axis=1),
        velocity_covariance=np.tile(0.5 * NOISE**2 * np.eye(2), (COUNT, 2, 1, 1)),
        common_errors=rng.normal(0.0, NOISE, (COUNT, 2, 2, 1)),
        normal_std=np.zeros(COUNT), spin_chain=np.arange(COUNT), spin_unknown=np.ones(COUNT, bool),
        time_since_contact=np.full(COUNT, np.nan),
        cluster=np.arange(COUNT) * LAUNCHES // COUNT,
    )  # fmt: skip


def test_a_wall_unlike_the_others_is_kept_and_a_single_outlier_is_not() -> None:
    kind = np.full(COUNT, bounce.WALL_Y0)
    kind[:6] = KINDS["x0"]
    data = contacts_that_keep(lambda x: np.full(COUNT, 0.9), kind)
    after = data.velocity_after.copy()
    after[:6, 1] = 0.45 * data.closing_speed[:6]  # the wall x0
    after[20, 1] = 0.3 * data.closing_speed[20]
    odd = replace(data, velocity_after=after)
    assert list(np.flatnonzero(~is_usual(odd, odd))) == [20]


def test_a_contact_that_no_friction_turns_so_far_is_left_out() -> None:
    """Of 0.9 of the restitution along the wall: 1.05 times that what a friction of 1 can change, and 0.95 times."""
    data = contacts_that_keep(lambda x: np.full(COUNT, 0.9))
    most = np.abs(data.velocity_before[:, 0]) + np.abs(data.velocity_after - data.velocity_before)[:, 1]
    after = data.velocity_after.copy()
    for row, share in ((7, 1.05), (8, 0.95)):
        after[row, 0] = data.velocity_before[row, 0] - np.sign(data.velocity_before[row, 0]) * share * most[row]
    odd = replace(data, velocity_after=after)
    assert list(np.flatnonzero(~is_usual(odd, odd))) == [7]


def test_outliers_are_judged_against_known_contacts() -> None:
    """A third of the contacts lose much more speed than the known ones; only these are rejected."""
    known = contacts_that_keep(lambda x: np.full(COUNT, 0.9))
    odd = np.arange(COUNT) % 3 == 0
    after = known.velocity_after.copy()
    after[odd, 1] *= 0.3
    other = replace(known, velocity_after=after)
    assert np.array_equal(is_usual(other, known), ~odd)
    assert not is_usual(replace(known, velocity_after=0.3 * known.velocity_after), known).any()


def test_no_spin_carries_over_past_a_contact_that_is_left_out() -> None:
    """Contacts number 2 and 5 of seven in two chains are omitted."""
    spin_chains, number = np.array([10, 10, 10, 10, 20, 20, 20]), np.array([0, 1, 3, 4, 6])
    some = select_contacts(contacts_that_keep(lambda x: np.full(COUNT, 0.9)), np.arange(COUNT) < len(number))
    found = split_spin_chains(replace(some, spin_unknown=np.zeros(len(number), bool)), number, spin_chains)
    assert [found.spin_chain[i] == found.spin_chain[i - 1] for i in range(1, len(number))] == [
        True,
        False,
        False,
        False,
    ]
    assert list(found.spin_unknown) == [False, False, True, False, True]


def test_a_chain_that_begins_with_an_unknown_spin_keeps_it_unknown() -> None:
    number = np.arange(3)
    some = select_contacts(contacts_that_keep(lambda x: np.full(COUNT, 0.9)), np.arange(COUNT) < 3)
    found = split_spin_chains(replace(some, spin_unknown=np.array([True, True, False])), number, np.array([1, 1, 2]))
    assert list(found.spin_unknown) == [True, True, False]


@pytest.mark.parametrize("wrong", [0, 6])
def test_a_few_outliers_do_not_decide_the_length_of_a_wave(wrong: int) -> None:
    """The true length is 0.61 m; the candidates next to it are 0.593 and 0.615 m."""
    data = contacts_that_keep(lambda x: 0.8 + 0.015 * np.sin(2.0 * np.pi * x / 0.61), wrong=wrong)
    problem = WallProblem(data, LAUNCHES, DEFAULTS)
    use = np.arange(LAUNCHES)
    columns = identifiable(problem.columns({"wall_restitution": 0.8}, (), None), problem, use)
    waves = [law.name for law in columns.families if law.variant_of == "share kept by a wave"]
    assert waves == ["share kept by a wave of 0.615 m along the walls"]


def test_no_contacts_are_a_problem_without_residuals() -> None:
    """As in a recording in which the puck touches no wall between two glides."""
    geometry = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
    problem = WallProblem(wall_contacts([], geometry), 3, {"length": 2.0, "width": 1.0})
    left = problem.residuals({}, problem.base, np.arange(3))
    assert left.r.shape == (0,) and left.jacobian.shape == (0, 1)
    np.testing.assert_array_equal(problem.freedom, np.zeros(3))
