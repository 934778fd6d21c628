"""Orders that reach the motors late: the mallets' paths against the reference, also in the camera's frames."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.physics.gantry.mallet import place_now
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.reference_play import PERIOD, asked_for, gentle

DELAY, STEPS = 0.055, 14
LATE = {"command_delay": {"delay_s": DELAY}}
CLEAN = {"camera_noise": 0.0, "camera_error": 0.0, "beam_noise": 0.0, "dropped_frames": 0.0, "held_frames": 0.0}


def played(variant: str, **parameters: float) -> tuple[Tables, np.ndarray, np.ndarray, list[list]]:
    """A table after STEPS; where the mallets were (steps + 1, 2, 2); its plans as they were made, of either mallet."""
    tables, rng = Tables(variant, 1, seed=3, effects=LATE, parameters=parameters), np.random.default_rng(5)
    places, plans = [_places(tables)], [[], []]
    for step in range(STEPS):
        actions = gentle(tables, rng)
        for k, plan in enumerate(asked_for(tables, actions)):
            plans[k].append((PERIOD * step, plan))
        tables.step(actions)
        places.append(_places(tables))
    return tables, np.array(places), np.arange(STEPS + 1) * PERIOD, plans


def _places(tables: Tables) -> list[tuple[float, float]]:
    return [place_now(mallet) for mallet in tables.states.view(np.recarray)[0].mallets]


@pytest.mark.slow
def test_mallets_go_where_the_reference_goes() -> None:
    _, places, times, plans = played("match-v0")
    for late, apart in ((DELAY, 0.0), (0.0, 0.01)):
        trace = run(Law(command_delay=late), None, places[0], plans, times[-1], 2e-5)
        seen = np.array([[np.interp(times, trace.t, path[:, c]) for c in (0, 3)] for path in trace.mallets])
        furthest = np.abs(seen.transpose(2, 0, 1) - places).max()
        assert furthest < 1e-6 if late else furthest > apart


def test_the_camera_sees_both_stretches_of_a_step() -> None:
    tables, places, times, plans = played("match-sensors-v0", **CLEAN)
    trace = run(Law(command_delay=DELAY), None, places[0], plans, times[-1], 2e-5)
    state, frames, rate = tables.states[0], tables._frames[0], float(tables.params["frame_rate"][0])
    newest, into_step = int(state["last_frame"]), set()
    for number in range(newest - 11, newest + 1):
        frame, t = frames[number & (len(frames) - 1)], (number + state["frame_phase"]) / rate
        expected = [[np.interp(t, trace.t, path[:, c]) for c in (0, 3)] for path in trace.mallets]
        seen = [(frame["mallets"][k]["x"], frame["mallets"][k]["y"]) for k in range(2)]
        if np.abs(np.array(seen) - expected).max() < 1e-5:  # others were not taken: in their places are older ones
            into_step.add(round(t - times[-2], 3))
    assert len(into_step) == 5 and min(into_step) < DELAY < max(into_step)


def test_the_puck_goes_where_the_reference_goes() -> None:
    """Four milliseconds late, so that pucks mostly meet nothing meanwhile, and then the mallet's new plan."""
    effects, rng = {"command_delay": {"delay_s": 0.004}}, np.random.default_rng(8)
    tables = Tables("match-v0", 6, seed=3, effects=effects)
    before, states, struck = _places(tables), tables.states.view(np.recarray), 0
    for table in range(len(tables)):
        puck, x, y = states[table].puck, *before[0]
        puck.x, puck.y, puck.vx, puck.vy = x + 0.1 + 0.005 * table, y + 0.002 * table, -1.0, 0.05
    begun = [(q.x, q.y, q.vx, q.vy) for q in states.puck]
    actions = np.repeat(gentle(tables, rng)[:1], len(tables), axis=0)
    plans = [[(0.0, plan)] for plan in asked_for(tables, actions)]
    tables.step(actions)
    for table, start in enumerate(begun):
        late, prompt = (run(Law(command_delay=d), start, before, plans, 0.1, 1e-5) for d in (0.004, 0.0))
        found = states[table].puck
        assert np.hypot(found.x - late.puck[-1, 0], found.y - late.puck[-1, 1]) < 1e-4
        struck += np.hypot(*(late.puck[-1, :2] - prompt.puck[-1, :2])) > 2e-4
    assert struck > 0


def test_a_turned_table_plays_the_same_game() -> None:
    tables, turned = (Tables("match-v0", 16, seed=3, effects=LATE) for _ in range(2))
    rng, (low, high) = np.random.default_rng(1), tables.action_bounds
    for step in range(60):
        actions = np.clip(rng.uniform(low, high, (16, 2, 4)).astype(np.float32), low, high)
        turned.restore(tables.snapshot())
        turned.turn()
        tables.step(actions)
        turned.step(np.ascontiguousarray(actions[:, ::-1]))
        if step < 5:  # later pucks hang on the last digits
            np.testing.assert_allclose(tables.observations, turned.observations[:, ::-1], atol=1e-4)
        for axis in "xy":
            there = turned.states["mallets"][axis]["slow"][:, ::-1]
            np.testing.assert_allclose(tables.states["mallets"][axis]["slow"], -there, atol=1e-9)


def test_a_new_episode_knows_no_orders_of_the_one_before() -> None:
    tables, rng = Tables("match-v0", 1, seed=3, effects=LATE), np.random.default_rng(5)
    for _ in range(3):
        tables.step(gentle(tables, rng))
    tables.reset(4)
    still = gentle(tables, rng)
    home = _places(tables)
    still[0, :, 0], still[0, :, 1] = home[0]  # where both are, each in its own frame
    tables.step(still)
    np.testing.assert_allclose(_places(tables), home, atol=1e-6)


def test_orders_later_than_the_next_are_refused() -> None:
    with pytest.raises(ValueError, match=r"^command_delay is 0.055 s; expected less than the period of 0.02 s$"):
        Tables("match-v0", 1, effects=LATE, period=0.02)
