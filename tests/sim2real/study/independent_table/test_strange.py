"""The reference's unlisted laws, and the second forms of listed ones, against results computed by hand."""

from __future__ import annotations

from dataclasses import replace
from math import cos, exp, hypot, log, pi, sin

import pytest

from sim2real.study.independent_table import Law, run

ICE = Law(friction=0.0, drag=0.0)
ROUGH = Law(drag=0.0)  # friction 0.125


def end(law: Law, start: tuple[float, ...], duration: float = 1.0, clock: float = 0.0) -> tuple[float, float]:
    """The puck's velocity at the end."""
    vx, vy = run(law, start, duration=duration, clock=clock).puck[-1, 2:]
    return float(vx), float(vy)


def test_a_vector_of_friction_brakes_x_and_y_apart():
    law = replace(ROUGH, friction_ratio=4.0)
    assert end(law, (0.5, 0.5, 0.8, 0.0)) == pytest.approx((0.8 - 0.25, 0.0), abs=1e-10)
    assert end(law, (0.5, 0.2, 0.0, 0.6)) == pytest.approx((0.0, 0.6 - 0.0625), abs=1e-10)
    vx, vy = end(law, (0.5, 0.4, 0.3, 0.3), duration=1e-3)
    assert (0.3 - vx, 0.3 - vy) == pytest.approx((0.25e-3 / 2**0.5, 0.0625e-3 / 2**0.5), rel=1e-3)


def test_a_vortex_pulls_round_its_middle_hardest_at_its_size():
    law = replace(ICE, vortex=0.06, vortex_x=1.0, vortex_y=0.5, vortex_size=0.25)
    for place, pull in (((1.25, 0.5), (0.0, 0.06)), ((1.0, 0.75), (-0.06, 0.0)), ((1.0, 0.5), (0.0, 0.0))):
        assert end(law, (*place, 0.0, 0.0), 0.01) == pytest.approx([0.01 * a for a in pull], abs=1e-8)
    weaker = 0.06 * 1.2 * exp(0.5 - 0.5 * 1.2**2)
    assert end(law, (1.3, 0.5, 0.0, 0.0), 0.01)[1] == pytest.approx(0.01 * weaker, rel=1e-5)


def test_a_washboard_gives_and_takes_by_its_potential():
    law = replace(ICE, washboard=0.2, washboard_length=0.4)
    trace = run(law, (0.5, 0.5, 0.6, 0.0), duration=1.2)
    k = 2.0 * pi / 0.4
    gained = 0.2 / k * (cos(k * 0.5) - cos(k * trace.puck[-1, 0]))
    assert trace.puck[-1, 2] ** 2 == pytest.approx(0.36 + 2.0 * gained, abs=1e-9)
    assert abs(gained) > 1e-3


def test_laws_that_change_with_time():
    drifts = replace(ICE, tilt_drift_x=0.01, tilt_drift_y=-0.02, tilt_drift_from=3.0)
    assert end(drifts, (0.5, 0.5, 0.1, 0.1), clock=4.0) == pytest.approx((0.115, 0.07), abs=1e-10)  # 1.5 s^2
    breathes = replace(ROUGH, breathing=0.5, breathing_period=4.0)
    assert end(breathes, (0.5, 0.5, 0.8, 0.0))[0] == pytest.approx(0.8 - 0.125 * (1.0 + 1.0 / pi), abs=1e-10)


def test_a_push_for_a_while_and_friction_in_pulses():
    push = replace(ICE, push_x=0.1, push_y=-0.2, push_from=1.2, push_until=1.7)
    assert end(push, (0.5, 0.5, 0.1, 0.1), clock=1.0) == pytest.approx((0.15, 0.0), abs=1e-4)
    pulse = replace(ROUGH, pulse=0.5, pulse_period=0.4)
    assert end(pulse, (0.5, 0.5, 0.8, 0.0))[0] == pytest.approx(0.8 - 0.125 * (1.0 + 0.5 * 0.6), abs=1e-4)


def test_a_stretch_of_one_wall_that_is_softer():
    law = replace(ICE, stretch_wall=2, stretch_extra=-0.2, stretch_from=0.8, stretch_until=1.2)  # y0
    for x, kept in ((1.0, 0.5), (0.5, 0.7)):
        assert end(law, (x, 0.3, 0.0, -1.0), 0.5)[1] == pytest.approx(kept, abs=1e-9)
    assert end(law, (1.0, 0.7, 0.0, 1.0), 0.5)[1] == pytest.approx(-0.7, abs=1e-9)


def test_laws_of_speed():
    assert end(replace(ICE, cubic_drag=0.3), (0.2, 0.5, 1.2, 0.0))[0] == pytest.approx(
        (1.2**-2 + 0.6) ** -0.5, abs=1e-10
    )
    slow = replace(ICE, slow_friction=0.12, slow_speed=0.3)
    assert end(slow, (0.5, 0.5, 0.4, 0.0))[0] == pytest.approx(0.3 * log(exp(0.4 / 0.3) - 0.4), abs=1e-10)


def test_laws_of_heading():
    grain, nap = replace(ROUGH, grain=0.4), replace(ROUGH, nap=0.4, nap_heading=0.5 * pi)
    for law, heading, factor in ((grain, 0.0, 1.4), (grain, 0.25 * pi, 0.6), (nap, 0.5 * pi, 1.4), (nap, 0.0, 1.0)):
        after = end(law, (0.5, 0.4, 0.5 * cos(heading), 0.5 * sin(heading)), 0.5)
        assert hypot(*after) == pytest.approx(0.5 - 0.0625 * factor, abs=1e-9)


def test_a_stripe_brakes_inside_alone():
    law = replace(ROUGH, stripe=0.3, stripe_x=1.0, stripe_width=0.2)
    assert end(law, (0.95, 0.5, 0.1, 0.0), 0.1)[0] == pytest.approx(0.1 - 0.0425, abs=1e-10)
    assert end(law, (0.75, 0.5, 0.1, 0.0), 0.1)[0] == pytest.approx(0.1 - 0.0125, abs=1e-10)


def test_friction_that_fades_after_a_hit():
    law = replace(ICE, fading=0.5, fading_time=0.2)
    assert end(law, (1.0, 0.5, 0.5, 0.0), 0.3)[0] == 0.5  # let go, not hit
    trace = run(law, (1.0, 0.2, 0.0, -1.0), duration=0.5)
    since = 0.5 - trace.contacts[0].t
    assert trace.puck[-1, 3] == pytest.approx(0.7 - 0.1 * (1.0 - exp(-since / 0.2)), abs=1e-8)
    first = run(law, (1.0, 0.2, 0.0, -1.0), duration=0.3)
    second = run(law, first.end_puck, duration=0.2)
    assert second.puck[-1, 3] == pytest.approx(trace.puck[-1, 3], abs=1e-8)


def test_restitution_by_a_power_of_the_speed():
    law = replace(ICE, restitution_power=0.2)
    assert end(law, (1.0, 0.2, 0.0, -2.0), 0.3)[1] == pytest.approx(2.0 * 0.7 * 2.0**-0.2, abs=1e-10)
    assert end(law, (1.0, 0.032, 0.0, -0.05), 0.1)[1] == pytest.approx(0.05, abs=1e-10)  # no more than comes in


def test_restitution_by_place_and_by_time():
    wave = replace(ICE, wall_wave=0.1, wall_wave_length=0.8)
    assert end(wave, (0.2, 0.2, 0.0, -1.0), 0.3)[1] == pytest.approx(0.8, abs=1e-10)
    assert end(wave, (0.2, 0.6 + 0.2, -1.0, 0.0), 0.3)[0] == pytest.approx(0.7, abs=1e-10)  # along x0 it is y
    assert end(replace(ICE, wall_warming=-0.01), (0.2, 0.2, 0.0, -1.0), 0.3, clock=9.8309)[1] == pytest.approx(
        0.6, abs=1e-9
    )
    law = replace(ICE, mallet_warming=-0.01)
    soft = run(law, (0.5, 0.5, -1.0, 0.0), [(0.3, 0.5)], duration=0.3, clock=10.0 - (0.2 - 0.0814))
    assert soft.puck[-1, 2] == pytest.approx(0.6, abs=1e-9)
