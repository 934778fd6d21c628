"""Estimates of what the camera sees, predicted to a later moment."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.parameters import make_records
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.simulate import run
from sim2real.table.game.moving_objects import SeenTable

P = make_records(1)[0]
RATE = 120.0


@pytest.mark.slow
def test_a_puck_is_predicted_past_a_bounce() -> None:
    """The truth is the independent table's."""
    seen, random = SeenTable(P), np.random.default_rng(1)
    trace = run(Law(), (1.0, 0.5, 0.4, 1.5), duration=1.0, sample=1 / RATE / 10)
    for frame in range(20):
        x, y = trace.puck[10 * frame, :2] + 1e-4 * random.standard_normal(2)
        seen.puck.update(frame / RATE, (float(x), float(y)))
    assert trace.contacts and trace.contacts[0].t > 20 / RATE
    late = 600  # samples, half a second: after the wall
    expected = seen.puck_at(late / RATE / 10)
    assert trace.contacts[0].t < late / RATE / 10
    assert expected is not None and expected[:2] == pytest.approx(trace.puck[late, :2], abs=0.005)
    assert expected[2:] == pytest.approx(trace.puck[late, 2:], abs=0.02)


@pytest.mark.parametrize("speed", [2.0, 6.0])
def test_the_estimate_keeps_up_with_a_puck_that_slows_down(speed: float) -> None:
    """A track of constant velocity is 0.05 m/s too fast at 6 m/s; the truth is the independent table's."""
    seen, law = SeenTable(P), Law()
    trace = run(law, (0.1, 0.5, speed, 0.0), duration=0.2, sample=1 / RATE)
    for frame in range(len(trace.puck)):
        seen.puck.update(frame / RATE, tuple(trace.puck[frame, :2]))
    found = seen.puck.motion()
    assert not trace.contacts and speed - trace.puck[-1, 2] > 0.03
    assert found is not None and found[2:] == pytest.approx(trace.puck[-1, 2:], abs=0.002)


def test_the_velocity_after_a_bounce_is_known_at_once() -> None:
    """In the first frame after a wall, and nearly so after a mallet; the truth is the independent table's."""
    trace = run(Law(), (1.0, 0.5, 0.4, 3.0), duration=0.5, sample=1 / RATE)
    after = int(np.ceil(trace.contacts[0].t * RATE))
    seen = SeenTable(P)
    for frame in range(after + 1):
        seen.puck.update(frame / RATE, tuple(trace.puck[frame, :2]))
    found = seen.puck.motion()
    assert found is not None and found[2:] == pytest.approx(trace.puck[after, 2:], abs=0.05)
    seen = SeenTable(P)
    for frame in range(20):
        seen.puck.update(frame / RATE, (1.0 + 0.01 * frame, 0.5))
    seen.puck.update(20 / RATE, (1.15, 0.55))  # struck
    found = seen.puck.motion()
    assert found is not None and found[2:] == pytest.approx((-0.04 * RATE, 0.05 * RATE), rel=0.02)


def test_what_was_seen_once_or_never_is_not_known() -> None:
    seen = SeenTable(P)
    assert seen.puck_at(0.0) is None and seen.puck.unseen_for(1.0) == np.inf
    seen.puck.update(0.0, (1.0, 0.5))
    assert seen.puck_at(0.0) is None
    seen.puck.update(1 / RATE, (1.0, 0.5))
    assert seen.puck_at(1 / RATE) == pytest.approx((1.0, 0.5, 0.0, 0.0), abs=1e-6)
    seen.puck.update(2 / RATE, None)
    assert seen.puck.unseen_for(0.1) == pytest.approx(0.1 - 1 / RATE)
    seen.forget()
    assert seen.puck_at(0.1) is None


def test_the_opponent_stays_in_its_half() -> None:
    seen = SeenTable(P)
    for frame in range(10):
        seen.opponent.update(frame / RATE, (1.06 - 0.05 * frame / 10, 0.5))
    x, y, vx, _ = seen.opponent_at(9 / RATE + 1.0) or (0.0, 0.0, 0.0, 0.0)
    assert (x, y) == pytest.approx((1.0, 0.5), abs=1e-3) and vx < -0.3
