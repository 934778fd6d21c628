"""The puck never leaves the table, never enters a post or a mallet, and never gains energy from a wall.

Whatever the scene: hit at full speed, pinched against walls, posts, corners or the other mallet, pushed along.
"""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from puckpilot_env.physics.gantry.plan import plan_axis
from tests.puckpilot_env.physics import sweeps
from tests.puckpilot_env.physics.scenes import KINDS, UNITS
from tests.puckpilot_env.physics.table_driver import SAMPLE_COLUMNS, new_log, new_table, play, put_at_rest, record

DEEPEST_OUTSIDE, DEEPEST_IN_MALLET = 1e-6, 1e-4  # m, the bars of the specification
DEEPEST_SEEN = 1e-7  # m, what is kept in fact, even by an elastic puck squeezed to a kilometre a second
MOST_EVENTS = 150  # in 0.1 s; a pushed puck is touched about once a millisecond

TABLES = {
    "default": {},
    "ice": {"friction": 0.0, "drag": 0.0, "wall_restitution": 1.0, "mallet_restitution": 1.0},
    "sand": {"friction": 5.0, "drag": 5.0},
    "dead": {"wall_restitution": 0.0, "mallet_restitution": 0.0},
    "small": {"length": 1.0, "width": 0.5, "puck_radius": 0.02, "mallet_radius": 0.03, "goal_width": 0.1},
    "strong": {"max_voltage": 60.0, "puck_radius": 0.045},
}


def check(verdicts: np.ndarray, units: np.ndarray) -> np.ndarray:
    """Assert the bars on every scene that is one; returns those."""
    scenes = ~np.isnan(verdicts[:, 0])
    for column, bar in (
        (sweeps.OUTSIDE, DEEPEST_OUTSIDE),
        (sweeps.INTO_POST, DEEPEST_OUTSIDE),
        (sweeps.INTO_MALLET, DEEPEST_IN_MALLET),
    ):
        worst = int(np.argmax(np.where(scenes, verdicts[:, column], -np.inf)))
        assert verdicts[scenes, column].max() <= min(bar, DEEPEST_SEEN), (column, units[worst].tolist())
    gains = verdicts[scenes, sweeps.GAIN]
    assert gains.max() <= 1e-12, units[scenes][int(np.argmax(gains))].tolist()
    return verdicts[scenes]


@pytest.mark.slow
@pytest.mark.parametrize("name", TABLES)
def test_hard_scenes_on_every_table(name, effort):
    units = sweeps.random_units(1, 10_000 * effort)
    found = check(sweeps.judge(record(**TABLES[name]), units, 0.1, 200), units)
    assert len(found) > 0.4 * len(units)
    assert np.isin(np.arange(KINDS), (units[:, 0] * KINDS).astype(int)).all()


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "scenes", "pieces"), [(1 / 120, 60_000, 20), (0.1, 40_000, 200), (1.0, 8000, 400)])
def test_hard_scenes_of_every_length(seconds, scenes, pieces, effort):
    units = sweeps.random_units(2, scenes * effort)
    found = check(sweeps.judge(record(), units, seconds, pieces), units)
    assert (found[:, sweeps.MALLET_EVENTS] > 0).mean() > 0.2
    assert (found[:, sweeps.STALLED] > 0).mean() > 0.01
    assert found[:, sweeps.EVENTS].max() <= MOST_EVENTS * max(1.0, 10.0 * seconds)


@pytest.mark.slow
def test_cutting_an_interval_changes_nothing(effort):
    units = sweeps.random_units(3, 40_000 * effort)
    found = sweeps.judge(record(), units, 0.1, 200)
    found = found[(found[:, sweeps.STALLED] == 0) & (found[:, sweeps.GRAZED] == 0)]
    # Each mallet multiplies the rounding of contacts before it by ten or so.
    few = (found[:, sweeps.EVENTS] <= 3) & (found[:, sweeps.MALLET_EVENTS] <= 1)
    assert few.mean() > 0.5
    assert found[few, sweeps.MOVED_BY_CUTS].max() <= 1e-7
    assert np.median(found[:, sweeps.MOVED_BY_CUTS]) <= 1e-12
    assert np.quantile(found[~few, sweeps.MOVED_BY_CUTS], 0.99) <= 1e-7


def test_a_puck_that_brushes_a_post_meets_it_once():
    """Touching, and moving at a right angle to the normal but for rounding: no endless contact, no speed lost twice."""
    p, out, log = record(), np.zeros((2, SAMPLE_COLUMNS)), new_log()
    for angle in np.linspace(0.02, 0.5 * np.pi, 2000):
        for turn in (-1.0, 1.0):
            table = new_table(p)
            for k, x in enumerate((0.9, 1.7)):
                put_at_rest(table.mallets[k].x, x)
                put_at_rest(table.mallets[k].y, 0.9)
                plan_axis(table.mallets[k].x, x, 1.0)
                plan_axis(table.mallets[k].y, 0.9, 1.0)
            puck = table.puck
            puck.x = p.puck_radius * np.cos(angle)
            puck.y = 0.5 - 0.5 * p.goal_width + p.puck_radius * np.sin(angle)
            puck.vx, puck.vy = -turn * 3.7 * np.sin(angle), turn * 3.7 * np.cos(angle)
            _, _, events = play(puck, p, table.mallets, 0.0, 0.02, out, log)
            assert events <= 3, angle


@given(arrays(np.float64, UNITS, elements=st.floats(0.0, 1.0)))
def test_scenes_that_hypothesis_seeks(unit):
    units = unit[None, :]
    verdicts = sweeps.judge(record(), units, 0.1, 200)
    assume(not np.isnan(verdicts[0, 0]))
    check(verdicts, units)
