"""A force inside a span of time or place: the reference's laws with edges, and what no span can be."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env.physics.effects.unlisted_window import EFFECT, OF_TIME, OF_X, OF_Y, misfit
from puckpilot_env.physics.sliding.slide import slide
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.effects.test_slide import FRICTION, draw_start, new_puck
from tests.puckpilot_env.physics.table_driver import record


def window(kind: int, begin: float, end: float, **more: float) -> dict[str, float]:
    rows = {"kind": float(kind), "from": begin, "until": end, **more}
    return {EFFECT.rows[short].name: value for short, value in rows.items()}


AWAY = 20.0  # m, the reference's walls
LAWS = {
    "push": (
        window(OF_TIME, 8.0, 13.0, push_x=0.06, push_y=-0.1),
        Law(push_x=0.06, push_y=-0.1, push_from=8.0, push_until=13.0),
    ),
    "pulse": (
        window(OF_TIME, 0.0, 0.7, every=1.4, brake=0.5 * FRICTION),
        Law(pulse=0.5, pulse_period=1.4),
    ),
    "stripe": (
        window(OF_X, 0.95, 1.1, brake=0.3),
        Law(stripe=0.3, stripe_x=1.025 + AWAY, stripe_width=0.15),
    ),
}


def ends(values: dict[str, float], law: Law, i: int, rng: np.random.Generator) -> float:
    """Distance [m] between the ends of a second's slide by the simulator and by the reference."""
    x, y, vx, vy, _ = draw_start(rng, i)
    clock = rng.uniform(6.0, 14.0)
    puck = new_puck(x, y, vx, vy)
    slide(puck, record(**values), clock, 1.0)
    large = Law(**{**vars(law), "length": 42.0, "width": 41.0})
    end = run(large, (x + AWAY, y + AWAY, vx, vy), duration=1.0, clock=clock, dt=1e-5).end_puck
    return math.hypot(puck.x + AWAY - end[0], puck.y + AWAY - end[1])


@pytest.mark.slow
@pytest.mark.parametrize("name", LAWS)
def test_a_second_of_sliding_is_the_reference_s(name: str) -> None:
    values, law = LAWS[name]
    rng, other = np.random.default_rng(5), np.random.default_rng(5)
    assert max(ends(values, law, i, rng) for i in range(16)) < 2e-5
    assert max(ends({}, law, i, other) for i in range(16)) > 1e-3


def test_a_strip_across_the_table_by_hand() -> None:
    """Half a metre at a speed of 1 m/s, of which 0.1 m is braked by 0.5 m/s^2: v^2 falls by 0.1."""
    p = record(friction=0.0, drag=0.0, **window(OF_Y, 0.4, 0.5, brake=0.5))
    puck = new_puck(1.0, 0.2, 0.0, 1.0)
    slide(puck, p, 0.0, 0.6)
    assert puck.vy == pytest.approx(math.sqrt(0.9), abs=1e-9)
    inside = 2.0 * 0.1 / (1.0 + math.sqrt(0.9))
    assert puck.y == pytest.approx(0.5 + (0.6 - 0.2 - inside) * math.sqrt(0.9), abs=1e-6)


def test_a_resting_puck_waits_for_the_push() -> None:
    p = record(friction=0.0, drag=0.0, **window(OF_TIME, 2.0, 3.0, push_x=0.2))
    puck = new_puck(1.0, 0.5, 0.0, 0.0)
    slide(puck, p, 1.5, 1.0)
    assert puck.vx == pytest.approx(0.1, abs=2e-3)  # it looks again every 5 ms


@pytest.mark.parametrize(
    ("rows", "why"),
    [
        ({"kind": 1.0, "from": 3.0, "until": 3.0}, "lasts from 3 until 3"),
        ({"kind": 1.0, "from": 0.0, "until": 3.0, "every": 2.0}, "comes every 2 s and lasts 3 s"),
        ({"kind": 2.0, "from": 0.0, "until": 1.0, "every": 2.0}, "is not of time"),
        ({"kind": 2.0, "from": 0.0, "until": 1.0}, ""),
        ({}, ""),
    ],
)
def test_what_no_span_can_be(rows: dict[str, float], why: str) -> None:
    found = misfit({short: rows.get(short, 0.0) for short in EFFECT.rows})
    assert why in found and bool(found) == bool(why)
