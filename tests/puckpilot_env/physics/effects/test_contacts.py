"""Walls, posts and mallets with their effects on, against the reference through up to three contacts."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from puckpilot_env.physics.contacts import bounce, contact
from puckpilot_env.physics.contacts.rebound import rebound, strike
from puckpilot_env.physics.effects import EFFECTS
from sim2real.study.independent_table import Law, Trace, run
from tests.puckpilot_env.physics.effects.pairs import CONTACTS
from tests.puckpilot_env.physics.effects.test_slide import new_puck
from tests.puckpilot_env.physics.table_driver import (
    PX,
    PY,
    SAMPLE_COLUMNS,
    areas,
    new_log,
    new_table,
    plan_both,
    play,
    put_at_rest,
    record,
)

CLOSE, MATTERS = 1e-5, 0.01  # m
STEP = 2.5e-5  # s, of the reference
STARTS = 8
SECONDS, SAMPLES = 1.0, 201
WAITING = (1.9, 0.06)  # m, of a mallet that is out of the way


def draw_start(rng: np.random.Generator, name: str) -> tuple[tuple[float, ...], tuple[float, float]]:
    """Puck, and the first mallet's place: aimed at what the effect is about."""
    speed = 10.0 ** rng.uniform(-0.7, 0.6)
    if name.startswith(("mallet", "unlisted_blow")):
        return (0.7, rng.uniform(0.45, 0.55), -speed - 0.5, 0.0), (0.2, 0.5)
    if name.startswith("corner"):
        return (0.5, 0.5, -2.0, rng.uniform(0.55, 0.75)), (0.9, 0.9)
    heading = rng.uniform(0.0, 2.0 * math.pi)
    if name.endswith("at an end"):
        return (0.5, rng.uniform(0.1, 0.9), -speed - 0.5, rng.uniform(-0.3, 0.3)), (0.9, 0.94)
    start = rng.uniform(0.3, 1.6), rng.uniform(0.1, 0.8), speed * math.cos(heading), speed * math.sin(heading)
    return start, (0.9, 0.94)


def play_simulator(values: dict[str, float], start, mallet) -> np.ndarray:
    """Samples (rows, SAMPLE_COLUMNS); both mallets stay where they are."""
    p = record(**values)
    table = new_table(p)
    places = (mallet, WAITING)
    for k, place in enumerate(places):
        put_at_rest(table.mallets[k].x, place[0])
        put_at_rest(table.mallets[k].y, place[1])
    requests = np.array([(*place, 5.0, 5.0) for place in places])
    plan_both(table.mallets, requests, areas(p), p.max_voltage)
    table.puck.x, table.puck.y, table.puck.vx, table.puck.vy = start
    samples = np.zeros((SAMPLES, SAMPLE_COLUMNS))
    _, rows, _ = play(table.puck, p, table.mallets, 0.0, SECONDS, samples, new_log())
    return samples[:rows]


def reference(law: Law, start, mallet) -> Trace:
    """The reference's motion, at the times of the samples."""
    return run(law, start, [mallet, WAITING], duration=SECONDS, dt=STEP, sample=SECONDS / (SAMPLES - 1))


def comparable(trace: Trace, rows: int, give: float) -> int:
    """Rows before the fourth contact; before the second where mallets recoil, for those of the simulator do not."""
    times = [c.t for c in trace.contacts][1:2] if give > 0.0 else [c.t for c in trace.contacts][3:4]
    before = int(min([SECONDS, *times]) / SECONDS * (SAMPLES - 1)) + 1
    return min(rows, before, int(np.isfinite(trace.puck[:, 0]).sum()))


@pytest.mark.slow
@pytest.mark.parametrize("name", CONTACTS)
def test_through_three_contacts_it_is_the_reference_s(name: str) -> None:
    values, law = CONTACTS[name]
    rng = np.random.default_rng(list(CONTACTS).index(name))
    contacts, changed = 0, 0.0
    for _ in range(STARTS):
        start, mallet = draw_start(rng, name)
        samples = play_simulator(values, start, mallet)
        trace = reference(law, start, mallet)
        if trace.near_miss < 1e-4:
            continue
        rows = comparable(trace, len(samples), law.mallet_give)
        apart = np.hypot(*(samples[:rows, [PX, PY]] - trace.puck[:rows, :2]).T)
        assert apart.max() < CLOSE, (start, trace.contacts)
        contacts += len(trace.contacts)
        if changed <= MATTERS:
            plain = reference(Law(), start, mallet)
            changed = float(np.nanmax(np.hypot(*(plain.puck[:rows, :2] - trace.puck[:rows, :2]).T)))
    assert contacts >= STARTS // 2
    assert changed > MATTERS, "the effect hardly acted"


def test_every_effect_of_a_contact_is_held_against_the_reference() -> None:
    """But for walls that are turned, which the simulator leaves at their places: see test_wall_alignment."""
    names = {name for name, e in EFFECTS.items() if e.regime in ("wall", "corner", "mallet")}
    assert names - {"wall_alignment"} <= {*CONTACTS}


velocity = st.floats(-8.0, 8.0)
direction = st.floats(0.0, 2.0 * math.pi)


@given(velocity, velocity, direction, st.floats(0.0, 1.0))
def test_without_effects_a_wall_is_the_baseline_s_to_the_last_digit(vx, vy, angle, e) -> None:
    nx, ny = math.cos(angle), math.sin(angle)
    puck = new_puck(0.5, 0.5, vx, vy)
    rebound(puck, record(wall_restitution=e), 0.0, bounce.POST, nx, ny)
    assert (puck.vx, puck.vy) == bounce.reflect(vx, vy, nx, ny, e)
    assert puck.spin == 0.0


@given(velocity, velocity, velocity, velocity, direction, st.floats(0.0, 1.0))
def test_without_effects_a_mallet_is_the_baseline_s_to_the_last_digit(vx, vy, mx, my, angle, e) -> None:
    nx, ny = math.cos(angle), math.sin(angle)
    puck = new_puck(0.5, 0.5, vx, vy)
    strike(puck, record(mallet_restitution=e), 0.0, mx, my, nx, ny)
    assert (puck.vx, puck.vy) == contact.reflect(vx, vy, mx, my, nx, ny, e)
    assert puck.spin == 0.0


@given(velocity, velocity, st.floats(-100.0, 100.0), st.floats(0.01, 1.0), st.floats(0.1, 1.0))
def test_a_rub_takes_energy_and_keeps_what_a_rub_keeps(vx, vy, spin, mu, inertia) -> None:
    """The impulse acts at the rim: v_t + inertia r spin is the same before and after, and no energy comes in."""
    p = record(wall_mu=mu, spin_inertia=inertia)
    puck = new_puck(0.5, 0.5, vx, -abs(vy) - 0.01, spin)
    before = puck.vx**2 + puck.vy**2 + inertia * (p.puck_radius * puck.spin) ** 2
    rebound(puck, p, 0.0, bounce.WALL_Y0, 0.0, 1.0)
    after = puck.vx**2 + puck.vy**2 + inertia * (p.puck_radius * puck.spin) ** 2
    assert after <= before * (1.0 + 1e-12)
    # the tangent of the wall y = 0 is -x
    kept = -vx + inertia * p.puck_radius * spin
    assert -puck.vx + inertia * p.puck_radius * puck.spin == pytest.approx(kept, abs=1e-9)


def test_restitution_stays_between_nothing_and_all() -> None:
    for slope, extra, expected in ((0.3, 0.0, 0.0), (0.0, 0.5, 1.0)):
        puck = new_puck(0.5, 0.5, 0.0, -5.0)
        rebound(puck, record(restitution_slope=slope, restitution_y0=extra), 0.0, bounce.WALL_Y0, 0.0, 1.0)
        assert puck.vy == pytest.approx(5.0 * expected)


def test_a_turned_table_turns_its_walls() -> None:
    p = record(restitution_y0=-0.2)
    puck = new_puck(0.5, 0.5, 0.0, 1.0)
    puck.turned = 1
    rebound(puck, p, 0.0, bounce.WALL_Y1, 0.0, -1.0)
    assert puck.vy == pytest.approx(-0.5)
    assert [bounce.opposite(bounce.opposite(kind)) for kind in range(11)] == list(range(11))


@given(
    velocity, velocity, st.floats(-100.0, 100.0), st.floats(0.1, 1.0), st.floats(0.0, 2.0),
    st.floats(-1e4, 1e4), st.floats(0.0, 1.0), st.booleans(),
)  # fmt: skip
def test_nothing_at_a_wall_or_mallet_adds_energy(vx, vy, spin, inertia, ratio, change, mu, at_mallet) -> None:
    """Whatever shares a table says, and a spin that they do not know of; the energy of motion and spin, by hand."""
    law = {"bounce_kind": 1.0, "bounce_share": 3.0, "blow_kind": 1.0, "blow_share": 3.0}
    law |= {f"bounce_{k:02}": change for k in range(5, 10)} | {f"blow_{k:02}": change for k in range(4, 8)}
    p = record(
        wall_mu=mu, mallet_mu=mu, spin_inertia=inertia, tangential_ratio=ratio, wall_restitution=1.0,
        mallet_restitution=1.0, restitution_power=-1.0, mallet_restitution_slope=-0.1, **law,
    )  # fmt: skip
    puck = new_puck(0.5, 0.5, vx, -abs(vy) - 0.01, spin)
    before = puck.vx**2 + puck.vy**2 + inertia * (p.puck_radius * puck.spin) ** 2
    if at_mallet:
        strike(puck, p, 0.0, 0.0, 0.0, 0.0, 1.0)
    else:
        rebound(puck, p, 0.0, bounce.WALL_Y0, 0.0, 1.0)
    after = puck.vx**2 + puck.vy**2 + inertia * (p.puck_radius * puck.spin) ** 2
    assert after <= before * (1.0 + 1e-12)
    assert puck.vy >= -1e-12
