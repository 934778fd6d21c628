"""A leg's path and the bounds on it, against numpy's polynomials."""

from __future__ import annotations

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.polynomial import Polynomial

from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.contact import TOUCH
from puckpilot_env.physics.contacts.curved_contact import NEVER, crossing, first_boundary
from puckpilot_env.physics.sliding import curve
from tests.puckpilot_env.physics.table_driver import record

SHARES = np.linspace(0.0, 1.0, 2001)
numbers = st.tuples(*[st.floats(-1.0, 1.0)] * 6)


@given(numbers, st.floats(1e-3, 0.1))
def test_it_goes_through_both_ends(ends, h):
    x0, v0, a0, x1, v1, a1 = ends
    path = Polynomial(curve.through(*ends, h))
    for s, expected in ((0.0, (x0, v0, a0)), (1.0, (x1, v1, a1))):
        found = path(s), path.deriv()(s) / h, path.deriv(2)(s) / h**2
        assert found == pytest.approx(expected, abs=1e-12 / h**2)


@given(numbers, st.floats(0.0, 1.0))
def test_place_rate_and_the_bound_on_its_bend(c, s):
    path = Polynomial(c)
    assert curve.place(c, s) == pytest.approx(path(s), abs=1e-12)
    assert curve.rate(c, s) == pytest.approx(path.deriv()(s), abs=1e-12)
    assert curve.most_bend(c) >= abs(path.deriv(2)(SHARES)).max() - 1e-12


@given(numbers, st.floats(-0.5, 0.5), st.sampled_from((-1.0, 1.0)))
def test_no_crossing_is_missed_and_none_is_made_up(c, line, side):
    """The first of 2,001 places beyond the line is not before the crossing; at it, the place is on the line."""
    gaps = side * (Polynomial(c)(SHARES) - line)
    if gaps[0] < 1e-6:
        return
    met = crossing(c, side, line, curve.most_bend(c), 0.0, 1.0, 0.0)
    beyond = SHARES[gaps < -1e-9]
    assert met <= (beyond[0] if len(beyond) else NEVER)
    if met < 1.0:
        assert abs(curve.place(c, met) - line) <= 2.0 * TOUCH
        assert side * curve.rate(c, met) < 0.0
    assert (gaps[min(met, 1.0) > SHARES] >= -2.0 * TOUCH).all()


@given(st.floats(0.04, 1.96), st.floats(0.04, 0.96), *[st.floats(-1.0, 1.0)] * 2, *[st.floats(-0.5, 0.5)] * 2)
def test_up_to_the_first_boundary_a_puck_is_on_the_table(x, y, vx, vy, ax, ay):
    """No wall, post or goal line is passed before what is met first, nor the middle line."""
    p = record()
    cx, cy = (x, vx, ax, 0.0, 0.0, 0.0), (y, vy, ay, 0.0, 0.0, 0.0)
    bends = curve.most_bend(cx), curve.most_bend(cy)
    met, kind = first_boundary(cx, cy, Polynomial(cx)(1.0), Polynomial(cy)(1.0), *bends, p, 0.0, 0.0)
    before = SHARES[met >= SHARES]
    px, py, radius = Polynomial(cx)(before), Polynomial(cy)(before), p.puck_radius
    slack = 1e-9
    assert (py >= radius - slack).all() and (py <= p.width - radius + slack).all()
    deep = np.minimum(px, p.length - px)
    in_mouth = abs(py - 0.5 * p.width) < 0.5 * p.goal_width
    assert (deep[~in_mouth] >= radius - slack).all() and (deep >= -slack).all()
    for post_x in (0.0, p.length):
        for side in (-0.5, 0.5):
            away = np.hypot(px - post_x, py - 0.5 * p.width - side * p.goal_width)
            assert (away >= radius - slack).all()
    if x != 0.5 * p.length:
        assert ((px - 0.5 * p.length) * (x - 0.5 * p.length) >= -slack).all()
    assert (kind == bounce.NOTHING) == (met >= 1.0)
