"""The reference table against results computed by hand, and against itself at half the step."""

from __future__ import annotations

import ast
from dataclasses import replace
from itertools import pairwise
from math import atan, cos, exp, hypot, sin, sqrt, tan

import numpy as np
import pytest
from scipy.linalg import expm

from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.aim import plan_to
from tests.places import ROOT

LAW = Law()
ICE = Law(friction=0.0, drag=0.0)
PRODUCT = {"puckpilot", "puckpilot_env", "agents", "baselines", "sim2real"}
OWN = "sim2real.study.independent_table"
COMPILING = "puckpilot_env.kernel"  # no physics: decorators that keep what numba compiled


def test_of_the_product_the_reference_imports_only_how_to_compile():
    files = sorted((ROOT / OWN.replace(".", "/")).rglob("*.py"))
    assert len(files) > 10
    for file in files:
        for node in ast.walk(ast.parse(file.read_text())):
            names = [alias.name for alias in node.names] if isinstance(node, ast.Import) else []
            if isinstance(node, ast.ImportFrom):
                assert node.level == 0, f"{file.name}: relative import"
                names = [node.module or ""]
            foreign = [name for name in names if name not in (OWN, COMPILING) and not name.startswith(f"{OWN}.")]
            assert not PRODUCT & {name.split(".")[0] for name in foreign}, f"{file.name} imports {foreign}"


# ---- glide


@pytest.mark.slow
def test_friction_alone_slows_evenly_and_stops():
    law = Law(friction=0.5, drag=0.0)
    trace = run(law, (0.5, 0.5, 0.3, 0.4), duration=1.5)  # 0.5 m/s stops after 1 s and 0.25 m
    t = np.minimum(trace.t, 1.0)
    along = 0.5 * t - 0.25 * t**2
    assert trace.puck[:, 0] == pytest.approx(0.5 + 0.6 * along, abs=1e-10)
    assert trace.puck[:, 1] == pytest.approx(0.5 + 0.8 * along, abs=1e-10)
    assert (trace.puck[-400:, 2:] == 0.0).all()


def test_the_stop_is_exact_inside_a_coarse_step():
    stop = run(Law(friction=0.5, drag=0.0), (0.5, 0.5, 0.49975, 0.0), duration=1.1, dt=1e-3).puck[-1]
    assert stop == pytest.approx((0.5 + 0.49975**2, 0.5, 0.0, 0.0), abs=1e-10)  # after 0.9995 s


def test_drag_alone_gives_the_logarithm():
    trace = run(Law(friction=0.0, drag=0.8), (0.1, 0.5, 2.0, 0.0))
    assert trace.puck[:, 0] == pytest.approx(0.1 + np.log1p(0.8 * 2.0 * trace.t) / 0.8, abs=1e-10)


def test_friction_and_drag_follow_the_tangent():
    trace = run(LAW, (0.3, 0.5, 1.2, 0.0))
    phase = atan(1.2 * sqrt(LAW.drag / LAW.friction)) - sqrt(LAW.drag * LAW.friction) * 1.0
    assert trace.puck[-1, 2] == pytest.approx(sqrt(LAW.friction / LAW.drag) * tan(phase), abs=1e-10)


def test_rest_stays_rest():
    assert (run(LAW, (1.0, 0.5, 0.0, 0.0), duration=0.1).puck == (1.0, 0.5, 0.0, 0.0)).all()


# ---- walls, posts, goals


@pytest.mark.parametrize(
    ("start", "which", "after"),
    [
        ((0.2, 0.2, -1.0, 0.5), "x0", (0.7, 0.35)),
        ((1.8, 0.2, 1.0, 0.5), "xL", (-0.7, 0.35)),
        ((1.0, 0.2, 0.5, -1.0), "y0", (0.35, 0.7)),
        ((1.0, 0.8, 0.5, 1.0), "yW", (0.35, -0.7)),
    ],
)
def test_wall_keeps_e_of_both_components(start, which, after):
    trace = run(ICE, start, duration=0.3)
    (hit,) = trace.contacts
    assert (hit.kind, hit.which) == ("wall", which)
    assert hit.t == pytest.approx(0.2 - LAW.puck_radius, abs=5e-12)
    assert trace.puck[-1, 2:] == pytest.approx(after, abs=1e-12)
    expected = np.array(start[:2]) + hit.t * np.array(start[2:]) + (0.3 - hit.t) * np.array(after)
    assert trace.puck[-1, :2] == pytest.approx(expected, abs=1e-11)


@pytest.mark.parametrize(("x", "vx", "y", "which"), [(0.2, -1.0, 0.34, "x0y0"), (1.8, 1.0, 0.66, "xLyW")])
def test_post_reflects_about_the_line_to_its_point(x, vx, y, which):
    trace = run(ICE, (x, 0.35 if y < 0.5 else 0.65, vx, 0.0), duration=0.25)
    (hit,) = trace.contacts
    assert (hit.kind, hit.which) == ("post", which)
    offset = 0.01 / LAW.puck_radius  # the puck's path passes 1 cm inside the post
    nx, ny = -np.sign(vx) * sqrt(1 - offset**2), offset if y < 0.5 else -offset
    assert (hit.nx, hit.ny) == pytest.approx((nx, ny), abs=1e-9)
    inward = vx * nx
    after = 0.7 * (np.array([vx, 0.0]) - 2.0 * inward * np.array([nx, ny]))
    assert trace.puck[-1, 2:] == pytest.approx(after, abs=1e-9)


def test_goal_ends_the_puck_and_a_miss_is_measured():
    trace = run(ICE, (0.3, 0.4, -1.0, 0.0), duration=0.5)
    (goal,) = trace.contacts
    assert (goal.kind, goal.which) == ("goal", "x0")
    assert goal.t == pytest.approx(0.3, abs=1e-12)
    assert np.isfinite(trace.puck[:300]).all()
    assert np.isnan(trace.puck[301:]).all()
    beside = run(ICE, (0.3, 0.372, -1.0, 0.0), mallets=[(0.5, 0.9)], duration=0.4)  # passes the post by 1.1 mm
    assert beside.near_miss == np.inf  # gone before it moves away from the post
    past = run(ICE, (0.9, 0.4, -1.0, 0.0), mallets=[(0.5, 0.5)], duration=0.8)
    assert past.near_miss == pytest.approx(0.1 - LAW.puck_radius - LAW.mallet_radius, abs=1e-9)


def test_without_mallets_the_puck_stays_inside_and_never_gains_energy():
    rng = np.random.default_rng(0)
    for _ in range(20):
        heading, speed = rng.uniform(-np.pi, np.pi), rng.uniform(1.0, 9.0)
        start = (rng.uniform(0.1, 1.9), rng.uniform(0.1, 0.9), speed * cos(heading), speed * sin(heading), 20.0)
        for law in (LAW, Law(wall_spin=True, wall_mu=0.3)):
            trace = run(law, start, dt=5e-5)
            energy = (trace.puck[:, 2:] ** 2).sum(axis=1) + 0.5 * (law.puck_radius * trace.spin) ** 2
            gone = np.isnan(energy)
            assert np.diff(energy[~gone]).max() <= 1e-12
            x, y = trace.puck[~gone, 0], trace.puck[~gone, 1]
            inside = (x >= law.puck_radius - 1e-12) & (x <= law.length - law.puck_radius + 1e-12)
            assert (inside | (abs(y - 0.5) < 0.16)).all()
            assert (abs(y - 0.5) <= 0.5 - law.puck_radius + 1e-12).all()


# ---- mallets


def terminal(law: Law, volts: float) -> float:
    return law.pulley_radius * volts / (2.0 * (law.a3 - law.b3))


@pytest.mark.parametrize("ratio", [0.0, 0.25])
def test_mallet_reflects_the_relative_velocity(ratio):
    law = replace(ICE, mallet_give=ratio)
    cruise = terminal(law, 3.0)
    mallet = (0.3, cruise, 0.0, 0.5, 0.0, 0.0)  # at terminal speed already, so it moves evenly
    trace = run(law, (0.8, 0.52, -1.0, 0.05), [mallet], [(3.0, 0.0, 9.0, 0.0, 9.0, 0.0)], duration=0.3)
    (hit,) = trace.contacts
    assert (hit.kind, hit.which, trace.unlogged) == ("mallet", "0", 0)
    assert hypot(hit.x - 0.3 - cruise * hit.t, hit.y - 0.5) == pytest.approx(0.0814, abs=1e-10)
    closing = -((-1.0 - cruise) * hit.nx + 0.05 * hit.ny)
    assert hit.closing == pytest.approx(closing, abs=1e-10)
    gain = (1.0 + 0.7) * closing / (1.0 + ratio)
    assert trace.puck[-1, 2:] == pytest.approx((-1.0 + gain * hit.nx, 0.05 + gain * hit.ny), abs=1e-10)
    assert trace.near_miss > 0.05  # a contact is no miss
    slowed = int(hit.t / 1e-3) + 1
    assert (trace.mallets[0, slowed, 1] < cruise - 0.01) == (ratio > 0.0)


def test_pushed_and_pinched_pucks_stay_sane():
    push = (8.0, 0.0, 9.0, 0.0, 9.0, 0.0)
    pushed = run(LAW, (0.5, 0.5, 0.0, 0.0), [(0.4, 0.5)], [push], duration=0.3)
    assert (pushed.puck[:, 0] - pushed.mallets[0, :, 0]).min() > 0.0814 - 1e-8
    for offset in (0.0, 1e-3, 0.04):
        pinched = run(LAW, (1.9, 0.2 + offset, 0.5, 0.0), [(1.7, 0.2)], [push], duration=0.4)
        assert np.isfinite(pinched.puck).all()
        assert len(pinched.contacts) < 200  # jammed: it does not bounce to and fro for ever
        assert pinched.puck[:, 0].max() <= LAW.length - LAW.puck_radius + 1e-12
        assert abs(pinched.puck[:, 1] - 0.5).max() <= 0.5 - LAW.puck_radius + 1e-12


# ---- gantry


def axis_exact(c5, c6, c7, half, state, intervals):
    """State after intervals of (volts, seconds), by the matrix exponential."""
    matrix = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, -c7 / c5, -c6 / c5, half / c5], [0, 0, 0, 0.0]])
    for volts, seconds in intervals:
        state = (expm(matrix * seconds) @ np.array([*state, volts]))[:3]
    return state


def test_axes_match_the_matrix_exponential_through_their_switches():
    start = (0.3, 0.8, -3.0, 0.5, -0.6, 12.0)
    trace = run(LAW, mallets=[start], plans=[(9.0, -7.0, 0.1000033, 0.0712345, 0.1700041, 0.1555555)], duration=0.25)
    x = axis_exact(
        5.2955e-6, 0.008449, 0.05315, 0.017653, start[:3], [(9.0, 0.1000033), (-9.0, 0.0700008), (0.0, 0.0799959)]
    )
    y = axis_exact(
        1.8625e-6, 0.002971, 0.05315, 0.017653, start[3:], [(-7.0, 0.0712345), (7.0, 0.084321), (0.0, 0.0944445)]
    )
    assert trace.mallets[0, -1, [0, 3]] == pytest.approx((x[0], y[0]), abs=1e-10)
    assert trace.mallets[0, -1, [1, 4]] == pytest.approx((x[1], y[1]), abs=1e-9)


def test_terminal_speed():
    trace = run(LAW, mallets=[(0.3, 0.5)], plans=[(2.0, -1.0, 9.0, 9.0, 9.0, 9.0)], duration=3.0, dt=1e-4, sample=1.0)
    assert trace.mallets[0, -1, [1, 4]] == pytest.approx((terminal(LAW, 2.0), terminal(LAW, -1.0)), abs=1e-7)


def test_a_list_of_plans_carries_the_mallet_over():
    first, second = (8.0, 3.0, 0.2, 0.1, 0.3, 0.2), (-5.0, 2.0, 0.05, 0.02, 0.1, 0.03)
    full = run(LAW, mallets=[(0.3, 0.5)], plans=[[(0.0, first), (0.1, second), (0.15, None)]], duration=0.3)
    begun = run(LAW, mallets=[(0.3, 0.5)], plans=[first], duration=0.1)
    middle = run(LAW, mallets=begun.end_mallets, plans=[second], duration=0.05)
    ended = run(LAW, mallets=middle.end_mallets, plans=[None], duration=0.15)
    assert full.end_mallets == pytest.approx(ended.end_mallets, abs=1e-9)


@pytest.mark.parametrize("target", [(0.7, 0.3), (0.34, 0.52), (0.1, 0.9)])
def test_plans_bring_the_mallet_to_rest_at_their_target(target):
    start = (0.35, 1.5, 2.0, 0.5, -0.8, 1.0)
    plan = plan_to(LAW, start, target, (9.0, 7.0))
    trace = run(LAW, mallets=[start], plans=[plan], duration=max(plan[4:]) + 0.005)
    assert (abs(plan[0]), abs(plan[1])) == (9.0, 7.0)
    assert trace.end_mallets[0, [0, 3]] == pytest.approx(target, abs=2e-5)
    assert trace.end_mallets[0, [1, 4]] == pytest.approx((0.0, 0.0), abs=1e-3)
    x, vx, ax, y, vy, ay = trace.end_mallets[0]
    limit = (x + (5.2955e-6 * ax + 0.008449 * vx) / 0.05315, y + (1.8625e-6 * ay + 0.002971 * vy) / 0.05315)
    assert limit == pytest.approx(target, abs=1e-9)  # where it goes when the voltage is off


# ---- the reference's own error


def test_halving_the_step_changes_nothing_that_matters():
    mallets, plans = [(0.3, 0.5), (1.6, 0.45)], [(9.0, 2.0, 0.2, 0.1, 0.3, 0.2), (-6.0, 0.0, 0.3, 0.0, 0.4, 0.0)]
    runs = [run(LAW, (0.9, 0.25, -1.5, 1.1), mallets, plans, dt=dt) for dt in (4e-4, 2e-4, 1e-4, 1e-5, 5e-6)]
    kinds = [contact.kind for contact in runs[-1].contacts]
    assert len(kinds) >= 3
    assert {"mallet", "wall"} <= set(kinds)
    steps = [abs(fine.puck[:, :2] - rough.puck[:, :2]).max() for rough, fine in pairwise(runs)]
    assert steps[1] < steps[0] / 8.0  # fourth order: 16, until rounding
    assert steps[-1] < 1e-10


# ---- effects, one oracle each


def test_tilt_adds_a_parabola_and_friction_holds_against_it():
    tilted = run(replace(ICE, tilt_x=0.3, tilt_y=-0.2), (0.5, 0.5, 0.2, 0.3))
    assert tilted.puck[-1] == pytest.approx((0.5 + 0.2 + 0.15, 0.5 + 0.3 - 0.1, 0.5, 0.1), abs=1e-10)
    assert (run(Law(tilt_x=0.1), (0.5, 0.5, 0.0, 0.0)).puck[-1] == (0.5, 0.5, 0.0, 0.0)).all()
    slides = run(Law(tilt_x=0.2, drag=0.0), (0.5, 0.5, 0.0, 0.0))
    assert slides.puck[-1, 0] == pytest.approx(0.5 + 0.5 * (0.2 - LAW.friction), abs=1e-10)


def test_other_glide_effects():
    still = run(replace(ICE, linear_drag=1.5), (0.5, 0.5, 0.6, 0.0)).puck[-1]
    assert still[2] == pytest.approx(0.6 * exp(-1.5), abs=1e-10)
    swerve = run(replace(ICE, side_force=0.7), (0.5, 0.3, 0.5, 0.0)).puck[-1]
    assert swerve[2:] == pytest.approx((0.5 * cos(0.7), 0.5 * sin(0.7)), abs=1e-10)
    bowl = run(replace(ICE, warp_xx=4.0), (1.3, 0.5, 0.0, 0.0)).puck[-1]
    assert bowl[0] == pytest.approx(1.0 + 0.3 * cos(2.0), abs=1e-10)
    drift = run(Law(drag=0.0, friction_drift=0.5), (0.5, 0.5, 1.0, 0.0), clock=2.0).puck[-1]
    assert drift[2] == pytest.approx(1.0 - 0.125 * (2.0 + 0.25), abs=1e-10)
    rough = Law(drag=0.0, patch_x=0.5, patch_y=0.5, patch_radius=0.1, patch_friction=0.4)
    assert run(rough, (0.5, 0.5, 0.1, 0.0), duration=0.1).puck[-1, 2] == pytest.approx(0.1 - 0.0525, abs=1e-10)
    assert run(rough, (0.8, 0.5, 0.1, 0.0), duration=0.1).puck[-1, 2] == pytest.approx(0.1 - 0.0125, abs=1e-10)
    grain = Law(drag=0.0, friction_anisotropy=0.2)
    assert run(grain, (0.5, 0.5, 0.5, 0.0)).puck[-1, 2] == pytest.approx(0.5 - 0.15, abs=1e-10)
    assert run(grain, (0.5, 0.2, 0.0, 0.5)).puck[-1, 3] == pytest.approx(0.5 - 0.10, abs=1e-10)


def test_wall_friction_slips_then_grips_and_spins():
    law = replace(ICE, wall_spin=True, spin_decay=2.0)
    slips = run(replace(law, wall_mu=0.1), (1.0, 0.2, 1.0, -1.0), duration=0.3)
    assert slips.puck[-1, 2:] == pytest.approx((1.0 - 0.17, 0.7), abs=1e-10)
    since = 0.3 - slips.contacts[0].t
    # the wall y = 0 drags the rim towards -x: the puck turns clockwise seen from above... as a wheel on a floor does
    assert slips.spin[-1] == pytest.approx(-0.17 / (0.5 * law.puck_radius) * exp(-2.0 * since), rel=1e-8)
    grips = run(replace(law, wall_mu=5.0, spin_decay=0.0), (1.0, 0.2, 1.0, -1.0), duration=0.3)
    assert grips.puck[-1, 2:] == pytest.approx((2.0 / 3.0, 0.7), abs=1e-10)
    assert grips.puck[-1, 2] + law.puck_radius * grips.spin[-1] == pytest.approx(0.0, abs=1e-9)  # it rolls


def test_other_wall_and_mallet_effects():
    def after(law: Law, start=(1.0, 0.2, 0.5, -1.0)) -> np.ndarray:
        return run(law, start, duration=0.3).puck[-1, 2:]

    assert after(replace(ICE, restitution_slope=0.1)) == pytest.approx((0.3, 0.6), abs=1e-10)
    assert after(replace(ICE, tangential_restitution=0.9)) == pytest.approx((0.45, 0.7), abs=1e-10)
    assert after(replace(ICE, odd_wall=2, odd_wall_extra=0.1)) == pytest.approx((0.4, 0.8), abs=1e-10)
    assert after(replace(ICE, odd_wall=3, odd_wall_extra=0.1)) == pytest.approx((0.35, 0.7), abs=1e-10)
    straight = (0.2, 0.3, -1.0, 0.0)
    assert hypot(*after(replace(ICE, post_restitution=0.4), (0.2, 0.35, -1.0, 0.0))) == pytest.approx(0.4, abs=1e-9)
    assert hypot(*after(replace(ICE, post_restitution=0.4), straight)) == pytest.approx(0.7, abs=1e-9)
    soft = run(replace(ICE, mallet_restitution_slope=0.2), (0.5, 0.5, -1.0, 0.0), [(0.3, 0.5)], duration=0.3)
    assert soft.puck[-1, 2] == pytest.approx(0.5, abs=1e-10)
    rubbed = run(replace(ICE, mallet_mu=0.1), (0.5, 0.45, -1.0, 0.0), [(0.3, 0.5)], duration=0.3)
    (hit,) = rubbed.contacts
    along = rubbed.puck[-1, 2] * -hit.ny + rubbed.puck[-1, 3] * hit.nx
    assert along == pytest.approx(hit.ny - np.sign(hit.ny) * 0.1 * 1.7 * hit.closing, abs=1e-9)


def test_gantry_effects():
    def speed(law: Law) -> np.ndarray:
        hold = (6.0, -3.0, 9.0, 9.0, 9.0, 9.0)
        return run(law, mallets=[(0.3, 0.5)], plans=[hold], duration=3.0, dt=1e-4, sample=1.0).mallets[0, -1, [1, 4]]

    sag = 1.0 + 0.02 * 9.0
    assert speed(Law(voltage_sag=0.02)) == pytest.approx((terminal(LAW, 6 / sag), terminal(LAW, -3 / sag)), abs=1e-6)
    one_axis = run(Law(voltage_sag=0.02), mallets=[(0.3, 0.5)], plans=[(6.0, -3.0, 9.0, 0.0, 9.0, 0.0)], duration=0.1)
    alone = run(LAW, mallets=[(0.3, 0.5)], plans=[(6.0 / sag, 0.0, 9.0, 0.0, 9.0, 0.0)], duration=0.1)
    assert one_axis.end_mallets == pytest.approx(alone.end_mallets, abs=1e-12)  # y's volts count, though y is done
    assert speed(Law(deadband=0.5)) == pytest.approx((terminal(LAW, 5.5), terminal(LAW, -2.5)), abs=1e-6)
    late = run(Law(command_delay=0.05), mallets=[(0.3, 0.5)], plans=[(6.0, 0.0, 0.1, 0.0, 0.2, 0.0)], duration=0.3)
    prompt = run(LAW, mallets=[(0.3, 0.5)], plans=[(6.0, 0.0, 0.1, 0.0, 0.2, 0.0)], duration=0.25)
    assert late.mallets[0, 50:, 0] == pytest.approx(prompt.mallets[0, :, 0], abs=1e-10)


def test_what_cannot_be_run_is_refused():
    with pytest.raises(ValueError, match="two mallets"):
        run(LAW, mallets=[(0.1, 0.1)] * 3)
    with pytest.raises(ValueError, match="dt > 0"):
        run(LAW, dt=0.0)
