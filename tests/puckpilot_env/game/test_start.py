"""Starts: what the variants promise of them, over 20,000 of each."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from scipy import stats

from puckpilot_env import Tables, all_variants
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from tests.puckpilot_env.game.hand import GOAL, LENGTH, MALLET, PUCK, WIDTH, put_mallet, seen, staying

COUNT = 20_000


@cache
def starts(variant: str) -> tuple[np.ndarray, np.ndarray]:
    """`(pucks, mallets)`: x, y, vx, vy of that many starts."""
    tables = Tables(variant, COUNT, seed=21)
    return puck_motion(tables.states), mallet_motion(tables.states)


@pytest.mark.parametrize("variant", all_variants())
def test_nothing_overlaps(variant):
    puck, mallets = starts(variant)
    apart = np.linalg.norm(mallets[:, :, :2] - puck[:, None, :2], axis=2)
    assert apart.min() > PUCK + MALLET
    assert ((puck[:, 0] >= PUCK) & (puck[:, 0] <= LENGTH - PUCK)).all()
    assert ((puck[:, 1] >= PUCK) & (puck[:, 1] <= WIDTH - PUCK)).all()
    assert ((mallets[..., 1] >= MALLET) & (mallets[..., 1] <= WIDTH - MALLET)).all()
    for player, near in ((0, 0.0), (1, 1.0)):
        x = mallets[:, player, 0]
        assert ((x >= near + MALLET) & (x <= near + 1.0 - MALLET)).all()
    assert (mallets[..., 2:] == 0).all()


def aims(puck: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Where each shot's straight line, unfolded at the side walls, meets the goal line, and at which wall it bounces.

    The wall is -1 (y = 0), 0 (none) or 1; the place is folded back onto the table.
    """
    y = puck[:, 1] - puck[:, 3] / puck[:, 2] * puck[:, 0]
    wall = np.where(y < PUCK, -1, np.where(y > WIDTH - PUCK, 1, 0))
    return np.where(wall < 0, 2 * PUCK - y, np.where(wall > 0, 2 * (WIDTH - PUCK) - y, y)), wall


def test_shots_leave_time():
    """At least 0.3 s to the goal line, even without friction, and from the other half."""
    puck, mallets = starts("defence-v0")
    assert (puck[:, 0] / -puck[:, 2]).min() >= 0.3 - 1e-9
    assert puck[:, 0].min() >= 1.1 and puck[:, 0].max() <= 1.7
    speed = np.linalg.norm(puck[:, 2:], axis=1)
    assert speed.min() >= 1.0 - 1e-12 and 6.0 < speed.max() <= 8.0
    assert (mallets[:, 1, 0] > puck[:, 0]).all()  # the shooter is behind the puck
    np.testing.assert_allclose(mallets[:, 0], np.tile([0.25, 0.5, 0, 0], (COUNT, 1)))


def test_shots_are_aimed_as_promised():
    """Evenly over 1.4 mouths, so 5 of 7 at the mouth; half direct, a quarter over each side wall."""
    aim, wall = aims(starts("defence-v0")[0])
    assert stats.kstest(aim, "uniform", (0.5 - 0.7 * GOAL, 1.4 * GOAL)).pvalue > 1e-3
    assert np.mean(np.abs(aim - 0.5) < 0.5 * GOAL) == pytest.approx(5 / 7, abs=0.015)
    for kind, share in ((-1, 0.25), (0, 0.5), (1, 0.25)):
        assert np.mean(wall == kind) == pytest.approx(share, abs=0.015)


def test_shots_on_target_go_in():
    """Nobody in the way: none is in within 0.2 s; those aimed well inside the mouth go in, those well beside do not."""
    tables = Tables("defence-v0", 4000, seed=5, autoreset=False, max_cycles=100)
    puck = puck_motion(tables.states)
    aim, _ = aims(puck)
    fast = np.linalg.norm(puck[:, 2:], axis=1) > 1.8  # slower ones may stop on the way
    put_mallet(tables, 0, 0.06, 0.06)
    scored = np.zeros(4000, bool)
    for step in range(1, 31):
        tables.step(staying(tables))
        scored |= tables.states["score"][:, 1] == 1
        assert step > 2 or not scored.any()
    inside, beside = np.abs(aim - 0.5) < 0.5 * GOAL - PUCK, np.abs(aim - 0.5) > 0.5 * GOAL + PUCK
    assert scored[inside & fast].mean() > 0.99 and (inside & fast).sum() > 1500
    assert scored[beside].mean() < 0.01 and beside.sum() > 300
    assert 0.55 < scored.mean() < 5 / 7


def test_attacks_start_with_a_clear():
    """J.1 case 1, of either kind of attack; the puck is in the subject's reach."""
    for variant in ("attack-v0", "attack-randomized-v0"):
        puck, _ = starts(variant)
        x, _, vx, vy = puck.T
        assert ((x >= 0.35) & (x <= 0.95)).all()
        assert (np.hypot(vx, vy) > 0.4).all() and (np.abs(vy) > 7.0 * np.abs(vx)).all()
        assert np.mean(vy > 0) == pytest.approx(0.5, abs=0.02) and np.mean(vx > 0) == pytest.approx(0.5, abs=0.02)


def test_flags_at_the_start():
    for variant, flags in (("match-v0", [1, 1]), ("defence-v0", [1, 0]), ("attack-v0", [0, 1])):
        states = Tables(variant, 10).states
        assert (states["defending"] == flags).all() and (states["held"] == 0).all() and (states["time"] == 0).all()


def test_face_off_favours_nobody():
    """Both at home, and what one sees is distributed as what the other sees."""
    tables = Tables("match-v0", COUNT, seed=2)
    puck, mallets = puck_motion(tables.states), mallet_motion(tables.states)
    np.testing.assert_allclose(mallets, np.tile([[0.25, 0.5, 0, 0], [1.75, 0.5, 0, 0]], (COUNT, 1, 1)))
    assert (puck[:, 0] == 1.0).all()
    assert np.mean(puck[:, 2] > 0) == pytest.approx(0.5, abs=0.015)
    assert stats.kstest(puck[:, 1], "uniform", (0.2, 0.6)).pvalue > 1e-3
    assert stats.kstest(np.hypot(puck[:, 2], puck[:, 3]), "uniform", (0.3, 0.5)).pvalue > 1e-3
    angle = np.arctan2(puck[:, 3], np.abs(puck[:, 2]))
    assert stats.kstest(angle, "uniform", (-np.pi / 4, np.pi / 2)).pvalue > 1e-3
    for name in ("puck_y", "puck_vx", "puck_vy"):
        assert stats.kstest(seen(tables, 0, name), seen(tables, 1, name)).pvalue > 1e-3


def test_starts_differ_from_table_to_table_and_episode_to_episode():
    tables = Tables("defence-v0", 1000, seed=2, max_cycles=1)
    first = puck_motion(tables.states)
    tables.reset()
    second = puck_motion(tables.states)
    assert len(np.unique(np.concatenate([first, second]), axis=0)) == 2000
    for a, b in zip(first.T, second.T, strict=True):
        assert abs(np.corrcoef(a, b)[0, 1]) < 0.14
        assert abs(np.corrcoef(a[1:], a[:-1])[0, 1]) < 0.14
