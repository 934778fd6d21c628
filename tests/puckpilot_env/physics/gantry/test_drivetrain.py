"""Dry friction, belts that give, and play: mallets and pucks in a game against the reference table."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.batch.motion import mallet_motion
from puckpilot_env.batch.trace import trace
from puckpilot_env.physics.effects.unlisted_drive import EFFECT, LOSS_BY_PLACE, LOSS_BY_SPEED, NUMBERS
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.reference_play import PERIOD, asked_for, gentle, played
from tests.puckpilot_env.physics.table_driver import record

STEPS = 14
FRICTION = {"motor_friction_left": 0.7, "motor_friction_right": 0.5, "axis_friction_x": 0.3, "axis_friction_y": 0.8}
DRIVE = EFFECT.row_names
RUBS = Law(motor_friction_left=0.7, motor_friction_right=0.5, axis_friction_x=0.3, axis_friction_y=0.8)
CASES = {  # the simulator's numbers, the reference's, and how close places [m] and velocities [m/s] are
    "friction": (FRICTION, RUBS, 4e-4, 5e-3),
    "belt": ({"belt_hz": 20.0, "belt_zeta": 0.08}, Law(belt_hz=20.0, belt_zeta=0.08), 2e-6, 1e-3),
    "play": ({"backlash_gap": 0.003}, Law(backlash=0.003), 2e-6, 1e-3),
    "friction, play and sag": (
        {**FRICTION, "backlash_gap": 0.002, "voltage_sag": 0.02},
        replace(RUBS, backlash=0.002, voltage_sag=0.02),
        4e-4,
        5e-3,
    ),
    "friction, belt and delay": (
        {**FRICTION, "belt_hz": 35.0, "command_delay": 0.055},
        replace(RUBS, belt_hz=35.0, belt_zeta=0.1, command_delay=0.055),
        4e-4,
        1e-2,
    ),
}


def at_steps(law: Law, places: np.ndarray, plans: list[list]) -> np.ndarray:
    """The reference's motion of both mallets (steps + 1, 2, 4) at the ends of the steps."""
    times = np.arange(len(plans[0]) + 1) * PERIOD
    trace = run(law, None, places, plans, times[-1], 1e-5)
    return np.array([[np.interp(times, trace.t, m[:, c]) for c in (0, 3, 1, 4)] for m in trace.mallets]).transpose(
        2, 0, 1
    )


@pytest.mark.slow
@pytest.mark.parametrize("case", CASES)
def test_mallets_go_where_the_reference_goes(case: str) -> None:
    values, law, close, alike = CASES[case]
    motion, plans = played(Tables("match-v0", 1, seed=3, parameters=values), STEPS)
    seen, without = (at_steps(one, motion[0, :, :2], plans) for one in (law, Law()))
    assert np.abs(seen - motion)[..., :2].max() < close
    assert np.abs(seen - motion)[..., 2:].max() < alike
    assert np.abs(without - motion)[..., :2].max() > 5.0 * close  # it matters


@pytest.mark.slow
@pytest.mark.parametrize("period", [1.0 / 120.0, 0.1, 1.0])
@pytest.mark.parametrize("case", CASES)
def test_within_steps_too(case: str, period: float) -> None:
    """At forty moments of each step, short or long."""
    values, law, close, _ = CASES[case]
    values = {**values, "command_delay": min(values.get("command_delay", 0.0), 0.5 * period)}
    law = replace(law, command_delay=values["command_delay"])
    steps, tables = max(int(1.5 / period), 2), Tables("match-v0", 1, seed=3, parameters=values, period=period)
    rng, plans, start = np.random.default_rng(5), [[], []], mallet_motion(tables.states)[0]
    moments, seen, actions = np.linspace(0.0, period, 41)[1:], [], gentle(tables, rng)
    for step in range(steps):
        if period * step % 0.1 < period:
            actions = gentle(tables, rng)
        for k, plan in enumerate(asked_for(tables, actions)):
            plans[k].append((period * step, plan))
        seen.append(mallet_motion(trace(tables, 0, actions[0], moments)[0])[:, :, :2])
        tables.step(actions)
    times = (np.arange(steps)[:, None] * period + moments).ravel()
    path = run(law, None, start[:, :2], plans, times[-1] + 1e-3, 2e-5, sample=2e-4)
    expected = [[np.interp(times, path.t, mallet[:, c]) for c in (0, 3)] for mallet in path.mallets]
    assert np.abs(np.concatenate(seen) - np.array(expected).transpose(2, 0, 1)).max() < max(close, 2e-5)


@pytest.mark.parametrize("variant", ["match-v0", "defence-randomized-v0", "match-sensors-v0"])
@pytest.mark.parametrize("period, delay, steps", [(0.1, 0.0, 120), (0.02, 0.0, 120), (0.02, 0.007, 40)])
def test_pieces_with_nothing_in_them_change_nothing(variant: str, period: float, delay: float, steps: int) -> None:
    """Friction of 1e-13 V cuts every step into pieces: what is seen, scored and drawn stays as it is.

    Without delay both are compared step by step from the same state, which does not tell what late orders are followed.
    """
    plain, pieces = (
        Tables(variant, 64, seed=3, period=period, parameters={"command_delay": delay, "axis_friction_x": friction})
        for friction in (0.0, 1e-13)
    )
    rng, (low, high), ends = np.random.default_rng(1), plain.action_bounds, 0
    for _ in range(steps):
        actions = np.clip(rng.uniform(low, high, (64, 2, 4)).astype(np.float32), low, high)
        if delay == 0.0:
            pieces.restore(plain.snapshot())
            pieces.params["axis_friction_x"] = 1e-13
        plain.step(actions)
        pieces.step(actions)
        np.testing.assert_array_equal(plain.states["score"], pieces.states["score"])
        np.testing.assert_array_equal(plain.states["stream"], pieces.states["stream"])
        ended = plain.terminated | plain.truncated
        np.testing.assert_allclose(plain.final_observations[ended], pieces.final_observations[ended], atol=1e-3)
        change = np.abs(plain.observations - pieces.observations).max(axis=(1, 2))
        assert np.quantile(change, 0.98) < 1e-3  # a puck in a wedge may hang on the last digits
        ends += int(ended.sum())
    assert ends > 0 or not variant.startswith("defence") or delay


def test_a_mallet_that_takes_up_play_touches_nothing_behind_it() -> None:
    tables = Tables("match-v0", 1, seed=3, parameters={"backlash_gap": 0.003, "friction": 0.0, "drag": 0.0})
    puck, (x, y) = tables.states.view(np.recarray)[0].puck, mallet_motion(tables.states)[0, 0, :2]
    puck.x, puck.y, puck.vx, puck.vy = x - 0.0309 - 0.0505 - 1e-4, y, 0.0, 0.0
    before = puck.x
    pulled(tables, 10.0, 1)
    assert mallet_motion(tables.states)[0, 0, 0] > x + 0.01
    assert (puck.x, puck.y, puck.vx, puck.vy) == (before, y, 0.0, 0.0)


@pytest.mark.slow
@pytest.mark.parametrize(
    "kind, last, share, law",
    [
        (LOSS_BY_PLACE, 1.0, lambda q: 0.3 * np.sin(2.0 * np.pi * q / 0.5), Law(rough=0.3, rough_length=0.5)),
        (LOSS_BY_SPEED, 3.0, lambda q: 0.2 * q**2, Law(cubic_loss=0.2)),
    ],
)
def test_a_table_of_volts_is_the_law_that_it_tells(kind: int, last: float, share, law: Law) -> None:
    """A loss of C7 v (1 + share) in the reference takes C7 share v / (R/2) volts; C7 is a3 on both axes."""
    p = record()
    numbers = -2.0 * p.a3 / p.pulley_radius * share(np.linspace(0.0, last, NUMBERS))
    values = dict(zip(DRIVE, [kind, 3.0, 0.0, last, *numbers], strict=True))
    motion, plans = played(Tables("match-v0", 1, seed=3, parameters=values), STEPS)
    seen, without = (at_steps(one, motion[0, :, :2], plans) for one in (law, Law()))
    matters = np.abs(without - motion)[:, 0, :2].max()  # of player_0: the other's gantry has the law in its own frame
    assert np.abs(seen - motion)[:, 0, :2].max() < 0.05 * matters and matters > 0.005


def pulled(tables: Tables, volts: float, steps: int) -> None:
    """Let both mallets be pulled along x, ahead in their own frames, by `volts`, and left where they are along y."""
    for _ in range(steps):
        actions = np.zeros((1, 2, 4), np.float32)
        actions[0] = [(0.9, 0.5, volts, 0.3)] * 2
        tables.step(actions)


def test_friction_holds_what_fewer_volts_pull() -> None:
    """By hand: both motors, alike, and the axis hold 0.2 + 0.2 + 0.3 V on x."""
    held = {"motor_friction_left": 0.2, "motor_friction_right": 0.2, "axis_friction_x": 0.3, "axis_friction_y": 0.1}
    for volts, moves in ((0.69, False), (0.71, True)):
        tables = Tables("match-v0", 1, seed=3, parameters=held)
        home = mallet_motion(tables.states)[0]
        pulled(tables, volts, 3)
        moved = np.abs(mallet_motion(tables.states)[0] - home)[:, 0].max()
        assert moved > 1e-4 if moves else moved == 0.0


def test_a_motor_that_stands_turns_the_way_of_the_mallet() -> None:
    """The left motor, whose belt travels with x - y, holds 2 V: what pulls along x moves the mallet diagonally."""
    tables = Tables("match-v0", 1, seed=3, parameters={"motor_friction_left": 2.0})
    begin = mallet_motion(tables.states)[0, 0]
    pulled(tables, 0.7, 2)
    moved = mallet_motion(tables.states)[0, 0] - begin
    assert moved[0] == pytest.approx(moved[1], abs=5e-6) and moved[0] > 0.005
    assert moved[2] == pytest.approx(moved[3], abs=1e-5)


def test_friction_stops_a_mallet_in_the_time_and_way_of_its_closed_form() -> None:
    """Under -1.2 V, what 1.5 V of friction leave of 0.3 V, v = (v0 + c) exp(-a t) - c, with c the speed of 1.2 V."""
    tables = Tables("match-v0", 1, seed=3, parameters={"axis_friction_x": 1.5})
    axis = tables.states["mallets"]["x"][0, 0:1]
    rate, c, v0 = float(axis["slow_rate"][0]), 1.2 * float(axis["rest_gain"][0]), 0.5
    begin = float(axis["rest"][0])
    axis["slow"], axis["rest"] = -v0 / rate, begin + v0 / rate
    stop = np.log(1.0 + v0 / c) / rate
    way = (v0 + c) * (1.0 - np.exp(-rate * stop)) / rate - c * stop
    pulled(tables, 0.3, int(stop / PERIOD))
    assert mallet_motion(tables.states)[0, 0, 2] > 0.01
    pulled(tables, 0.3, 2)
    x, _, vx, _ = mallet_motion(tables.states)[0, 0]
    assert x - begin == pytest.approx(way, abs=3e-4)  # which leaves out the fast mode of 0.6 ms
    assert vx == 0.0


@pytest.mark.parametrize(
    "values, law",
    [
        (FRICTION, RUBS),
        ({"belt_hz": 25.0}, Law(belt_hz=25.0, belt_zeta=0.1)),
        ({"backlash_gap": 0.002}, Law(backlash=0.002)),
    ],
    ids=["friction", "belt", "play"],
)
def test_the_camera_sees_mallets_where_they_are(values: dict[str, float], law: Law) -> None:
    clean = {"camera_noise": 0.0, "camera_error": 0.0, "beam_noise": 0.0, "dropped_frames": 0.0, "held_frames": 0.0}
    tables = Tables("match-sensors-v0", 1, seed=3, parameters={**values, **clean})
    motion, plans = played(tables, STEPS)
    reference = run(law, None, motion[0, :, :2], plans, STEPS * PERIOD, 2e-5)
    state, frames, rate = tables.states[0], tables._frames[0], float(tables.params["frame_rate"][0])
    newest, seen_well = int(state["last_frame"]), 0
    for number in range(newest - 11, newest + 1):
        frame, t = frames[number & (len(frames) - 1)], (number + state["frame_phase"]) / rate
        expected = [[np.interp(t, reference.t, path[:, c]) for c in (0, 3)] for path in reference.mallets]
        seen = [(frame["mallets"][k]["x"], frame["mallets"][k]["y"]) for k in range(2)]
        seen_well += np.abs(np.array(seen) - expected).max() < 3e-4  # others were not taken: there are older ones
    assert seen_well == 5


@pytest.mark.parametrize("name", CASES)
def test_the_puck_goes_where_the_reference_goes(name: str) -> None:
    values, law, _, _ = CASES[name]
    tables = Tables("match-v0", 6, seed=3, parameters=values)
    rng, states, struck = np.random.default_rng(8), tables.states.view(np.recarray), 0
    before = mallet_motion(tables.states)[0, :, :2]
    for table in range(len(tables)):
        puck, (x, y) = states[table].puck, before[0]
        puck.x, puck.y, puck.vx, puck.vy = x + 0.11 + 0.01 * table, y + 0.002 * table, -1.0, 0.05
    begun = [(q.x, q.y, q.vx, q.vy) for q in states.puck]
    actions = np.repeat(gentle(tables, rng)[:1], len(tables), axis=0)
    plans = [[(0.0, plan)] for plan in asked_for(tables, actions)]
    tables.step(actions)
    for table, start in enumerate(begun):
        found = states[table].puck
        there, plain = (run(one, start, before, plans, PERIOD, 1e-5).puck[-1] for one in (law, Law()))
        assert np.hypot(found.x - there[0], found.y - there[1]) < 3e-4
        assert np.hypot(found.vx - there[2], found.vy - there[3]) < 1e-2
        struck += np.hypot(*(there - plain)[:2]) > 1e-3
    assert struck > 1


TURNED = {
    **{name: case[0] for name, case in CASES.items()},
    "belt and play": {"belt_hz": 20.0, "backlash_gap": 0.002},
    **{
        f"volts {k}": dict(zip(DRIVE, [k, 3.0, 0.0, 1.0, *np.linspace(-0.9, 0.6, NUMBERS)], strict=True))
        for k in range(1, 9)
    },
}


@pytest.mark.parametrize("name", TURNED)
def test_a_turned_table_plays_the_same_game(name: str) -> None:
    tables, turned = (Tables("match-v0", 8, seed=3, parameters=TURNED[name]) for _ in range(2))
    rng, (low, high) = np.random.default_rng(1), tables.action_bounds
    for step in range(20):
        actions = np.clip(rng.uniform(low, high, (8, 2, 4)).astype(np.float32), low, high)
        turned.restore(tables.snapshot())
        turned.turn()
        tables.step(actions)
        turned.step(np.ascontiguousarray(actions[:, ::-1]))
        there, extent = mallet_motion(turned.states)[:, ::-1], np.array([2.0, 1.0])
        np.testing.assert_allclose(mallet_motion(tables.states)[..., :2], extent - there[..., :2], atol=1e-6)
        if step < 5:  # later pucks hang on the last digits
            np.testing.assert_allclose(tables.observations, turned.observations[:, ::-1], atol=1e-3)
