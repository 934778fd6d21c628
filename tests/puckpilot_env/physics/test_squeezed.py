"""A puck that is squeezed, rubbed or grazed keeps to what is around it, and few events say all that happens to it."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env.physics.contacts.hit import hit
from tests.puckpilot_env.physics.table_driver import (
    SAMPLE_COLUMNS,
    areas,
    new_log,
    new_table,
    plan_both,
    play,
    put_at_rest,
    record,
)

WAITING = (1.9, 0.06)  # m, of a mallet that is out of the way


def scene(p: np.record, mallet: tuple[float, float], target: tuple[float, float], puck: tuple[float, ...]):
    """A table on which player 0's mallet goes from `mallet` to `target` [m] at full volts; puck: x, y, vx, vy."""
    table = new_table(p)
    for k, place in enumerate((mallet, WAITING)):
        put_at_rest(table.mallets[k].x, place[0])
        put_at_rest(table.mallets[k].y, place[1])
    plan_both(table.mallets, np.array([(*target, 10.0, 10.0), (*WAITING, 1.0, 1.0)]), areas(p), p.max_voltage)
    table.puck.x, table.puck.y, table.puck.vx, table.puck.vy = puck
    return table


@pytest.mark.slow
@pytest.mark.parametrize("restitution", [{}, {"restitution_power": -1.0}, {"mallet_restitution_slope": -0.1}])
@pytest.mark.parametrize("resistance", [0.0, 5.0])
def test_an_elastic_puck_between_mallet_and_wall_is_never_inside_either(restitution, resistance) -> None:
    """Each bounce to and fro adds twice the mallet's speed; where that goes too far all come to rest."""
    p = record(
        width=0.5, wall_restitution=1.0, mallet_restitution=1.0, friction=resistance, drag=resistance, **restitution
    )
    reach = p.puck_radius + p.mallet_radius
    for start in np.linspace(0.0, 0.05, 11):
        table = scene(p, (0.5, 0.2), (0.5, 0.45), (0.5, 0.2 + reach + start, 0.0, 4.0))
        out = np.zeros((401, SAMPLE_COLUMNS))
        _, rows, _ = play(table.puck, p, table.mallets, 0.0, 0.3, out, new_log())
        x, y, mx, my = out[:rows, 1], out[:rows, 2], out[:rows, 5], out[:rows, 6]
        assert (reach - np.hypot(x - mx, y - my)).max() <= 1e-7
        assert y.max() <= p.width - p.puck_radius + 1e-9
        assert np.hypot(out[:rows, 3], out[:rows, 4]).max() <= 400.0


def test_a_puck_that_slides_along_a_waiting_mallet_meets_it_at_most_once() -> None:
    """It moves at a right angle to the normal but for rounding, and friction alone could bring the two together."""
    p = record()
    reach = p.puck_radius + p.mallet_radius
    for depth in (-1e-12, 0.0, 1e-12):
        for away in (0.0, 1e-15, 1e-10):
            for speed in (1e-6, 1e-4, 1e-2, 1.0):
                puck = (0.5 + reach + depth, 0.5, away, speed)
                table = scene(p, (0.5, 0.5), (0.5, 0.5), puck)
                out, log = np.zeros((2, SAMPLE_COLUMNS)), new_log()
                _, _, events = play(table.puck, p, table.mallets, 0.0, 0.02, out, log)
                assert events <= 1, (depth, away, speed)


@pytest.mark.parametrize("rubs", [{"mallet_mu": 1.0}, {"blow_kind": 1.0, "blow_share": 2.0, "blow_05": -1.0}])
def test_a_rubbed_puck_that_is_struck_against_a_wall_leaves_both(rubs) -> None:
    """By hand: after the blow neither the mallet nor the wall y = 0 is being run into."""
    p = record(**rubs)
    rng = np.random.default_rng(3)
    struck = 0
    for _ in range(400):
        angle = rng.uniform(0.3, math.pi - 0.3)  # of the mallet, seen from the puck, above the wall
        nx, ny = -math.cos(angle), -math.sin(angle)
        reach = p.puck_radius + p.mallet_radius
        x, y = 0.6, p.puck_radius
        mallet = (x - reach * nx, y - reach * ny)
        table = scene(p, mallet, (mallet[0] + 0.3 * nx, mallet[1] + 0.3 * ny), (x, y, *rng.uniform(-3.0, 3.0, 2)))
        table.puck.spin = rng.uniform(-50.0, 50.0)
        closing = -(table.puck.vx * nx + table.puck.vy * ny)
        if closing <= 0.0 or table.puck.vy < 0.0:
            continue
        struck += 1
        hit(table.puck, p, table.mallets, 0, 0.0, 0.0, 0.0, 0.0)
        vx, vy = table.puck.vx, table.puck.vy
        assert vy >= -1e-12, (angle, vx, vy)
        assert vx * nx + vy * ny >= -1e-12, (angle, vx, vy)
    assert struck > 50
