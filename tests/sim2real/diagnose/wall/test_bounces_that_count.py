"""Which bounces count, and what spin they carry on."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from puckpilot_env.physics import bounce
from sim2real.diagnose.contact_data import kept
from sim2real.diagnose.engine.ways import tellable
from sim2real.diagnose.wall.data import KINDS, Bounces, are_usual, chained
from sim2real.diagnose.wall.problem import WallProblem

COUNT, LAUNCHES, NOISE = 80, 20, 0.001
DEFAULTS = {row.name: row.default for row in TABLE}


def bounces_of(keep, kind: np.ndarray | None = None, wrong: int = 0) -> Bounces:
    """Bounces of the wall y0 (or `kind`) that keep `keep(x)` of both components at x [m]; `wrong` of them a quarter
    less. A number of the glides' law that is not known moves all of them."""
    rng = np.random.default_rng(5)
    closing, along = rng.uniform(0.4, 3.0, COUNT), rng.uniform(-2.0, 2.0, COUNT)
    x = rng.uniform(0.1, 1.9, COUNT)
    share = keep(x)
    share[rng.choice(COUNT, wrong, replace=False)] -= 0.25
    before = np.stack([along, -closing], axis=1)
    after = share[:, None] * np.stack([along, closing], axis=1) + rng.normal(0.0, NOISE, (COUNT, 2))
    return Bounces(
        kind=np.full(COUNT, bounce.WALL_Y0) if kind is None else kind, normal=np.tile([0.0, 1.0], (COUNT, 1)),
        t=np.arange(COUNT, dtype=float), before=before, after=after, place=np.stack([x, np.full(COUNT, 0.03)], axis=1),
        spread=np.tile(0.5 * NOISE**2 * np.eye(2), (COUNT, 2, 1, 1)), drift=rng.normal(0.0, NOISE, (COUNT, 2, 2, 1)),
        turn=np.zeros(COUNT), chain=np.arange(COUNT), lost=np.ones(COUNT, bool), since=np.full(COUNT, np.nan),
        cluster=np.arange(COUNT) * LAUNCHES // COUNT,
    )  # fmt: skip


def test_a_wall_unlike_the_others_is_kept_and_a_lone_odd_bounce_is_not() -> None:
    kind = np.full(COUNT, bounce.WALL_Y0)
    kind[:6] = KINDS["x0"]
    data = bounces_of(lambda x: np.full(COUNT, 0.9), kind)
    after = data.after.copy()
    after[:6, 1] = 0.45 * data.closing[:6]  # the wall x0
    after[20, 1] = 0.3 * data.closing[20]
    odd = replace(data, after=after)
    assert list(np.flatnonzero(~are_usual(odd, odd))) == [20]


def test_what_is_usual_is_what_known_bounces_say() -> None:
    """A third of them lose much more than those known: they are left out, and take no other along."""
    known = bounces_of(lambda x: np.full(COUNT, 0.9))
    odd = np.arange(COUNT) % 3 == 0
    after = known.after.copy()
    after[odd, 1] *= 0.3
    other = replace(known, after=after)
    assert np.array_equal(are_usual(other, known), ~odd)
    assert not are_usual(replace(known, after=0.3 * known.after), known).any()


def test_no_spin_is_carried_past_a_contact_that_is_left_out() -> None:
    """Of seven impacts in two chains, number 2 and number 5 are no clear bounces."""
    chains, number = np.array([10, 10, 10, 10, 20, 20, 20]), np.array([0, 1, 3, 4, 6])
    some = kept(bounces_of(lambda x: np.full(COUNT, 0.9)), np.arange(COUNT) < len(number))
    found = chained(replace(some, lost=np.zeros(len(number), bool)), number, chains)
    assert [found.chain[i] == found.chain[i - 1] for i in range(1, len(number))] == [True, False, False, False]
    assert list(found.lost) == [False, False, True, False, True]


def test_what_is_lost_before_a_chain_stays_lost_in_it() -> None:
    number = np.arange(3)
    some = kept(bounces_of(lambda x: np.full(COUNT, 0.9)), np.arange(COUNT) < 3)
    found = chained(replace(some, lost=np.array([True, True, False])), number, np.array([1, 1, 2]))
    assert list(found.lost) == [True, True, False]


@pytest.mark.parametrize("wrong", [0, 6])
def test_the_length_of_a_wave_is_not_decided_by_a_few_odd_bounces(wrong: int) -> None:
    """0.61 m, and the lengths that are looked for are 0.593 and 0.615 m thereabouts."""
    data = bounces_of(lambda x: 0.8 + 0.015 * np.sin(2.0 * np.pi * x / 0.61), wrong=wrong)
    problem = WallProblem(data, LAUNCHES, DEFAULTS)
    use = np.arange(LAUNCHES)
    columns = tellable(problem.columns({"wall_restitution": 0.8}, (), None), problem, use)
    waves = [law.name for law in columns.families if law.among == "share kept by a wave"]
    assert waves == ["share kept by a wave of 0.615 m along the walls"]
