"""Effects on whole tables: off by default, given, drawn, filmed, turned round, and unknown to scripted players."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pettingzoo
import pytest

from baselines import Seat
from puckpilot_env import Tables, find_variant, parameters
from puckpilot_env.batch.motion import puck_motion
from puckpilot_env.batch.trace import trace
from puckpilot_env.options.randomization import Draw
from puckpilot_env.physics.effects import EFFECTS, MODULES
from sim2real.study.independent_table.mechanisms import MECHANISMS

TILT = {"table_tilt": {"tilt_x": 0.1, "tilt_y": -0.05}}
SOME = {
    **TILT,
    "friction_patch": {"x": 0.6, "y": 0.3, "radius": 0.2, "extra": 0.5},
    "side_force": {"spin_coefficient": 0.005},
    "wall_friction_spin": {"mu": 0.2},
    "wall_to_wall_restitution": {"x1": 0.1, "y0": -0.2},
    "corner_restitution": {"extra": -0.3},
    "unlisted_bounce": {  # by place, of both speeds: each wall in a way of its own
        **{"kind": 4.0, "share": 3.0, "c00": 1.0, "c01": 1.0, "c02": 2.0, "c03": 2.0},
        **{"c05": 0.1, "c08": -0.05, "c14": 0.1, "c17": 0.15},
    },
    "unlisted_blow": {  # by place along the table, of both speeds: the two mallets in ways of their own
        **{"kind": 3.0, "share": 3.0, "c00": 0.2, "c01": 0.8, "c02": 1.2, "c03": 1.8},
        **{"c04": -0.2, "c05": 0.1, "c06": -0.1, "c07": 0.15},
    },
    "mallet_friction": {"mu": 0.1},
    "mallet_speed_restitution": {"slope": 0.03},
}


HOOKS = {
    "glide": ("is_on", "acceleration", "friction"),
    "wall": ("restitution", "tangent", "shares", "angle"),
    "corner": ("restitution",),
    "mallet": ("mallet_restitution", "mallet_impulse", "mallet_tangent", "mallet_shares"),
    "sensing": ("camera_map",),
    "gantry": ("loses", "delivered", "delay", "in_pieces", "dry_friction", "spring", "gap", "holds", "extra_volts"),
}


def actions_of(tables: Tables, steps: int) -> np.ndarray:
    rng, (low, high) = np.random.default_rng(1), tables.action_bounds
    return np.clip(rng.uniform(low, high, (steps, len(tables), 2, 4)).astype(np.float32), low, high)


def test_rows_are_off_by_default_and_their_names_are_no_one_else_s() -> None:
    names = [row.name for row in parameters.TABLE]
    assert len(set(names)) == len(names)
    for effect in EFFECTS.values():
        assert effect.rows and effect.depends_on and effect.law and effect.excited_by and effect.source
        for row in effect.rows.values():
            assert parameters.make_records(1)[row.name][0] == row.default


@pytest.mark.parametrize("name", EFFECTS)
def test_every_file_holds_what_the_recipe_asks_for(name: str) -> None:
    """Named as the reference names mechanisms; with kernels by the names of its regime's hooks."""
    module, effect = MODULES[name], EFFECTS[name]
    assert effect.listed == (name in MECHANISMS)
    assert not effect.listed or effect.regime == MECHANISMS[name].regime
    assert module.__doc__ and all(row.source and row.meaning and row.unit for row in effect.rows.values())
    hooks = {hook for hook in HOOKS[effect.regime] if hasattr(module, hook)}
    assert bool(hooks - {"is_on"}) != bool(effect.not_simulated) and ("is_on" in hooks) == (effect.regime == "glide")
    assert all(getattr(module, hook).__doc__ and hasattr(getattr(module, hook), "py_func") for hook in hooks)
    assert set(effect.depends_on) <= {"position", "speed", "heading", "time", "history", "command"}


@pytest.mark.parametrize("variant", ["match-v0", "match-sensors-v0"])
def test_an_effect_too_small_to_see_changes_nothing(variant: str) -> None:
    """The way through intervals of time, with hardly any force, is the way from event to event."""
    plain, faint = Tables(variant, 64, seed=3), Tables(variant, 64)
    apart = []
    for actions in actions_of(plain, 60):
        faint.restore(plain.snapshot())
        faint.params["tilt_x"] = 1e-300
        plain.step(actions)
        faint.step(actions)
        apart.append(np.abs(puck_motion(plain.states) - puck_motion(faint.states))[:, :2].max(axis=1))
    assert np.quantile(apart, 0.998) < 1e-6  # a puck in a wedge may hang on the last digits


def test_explicitly_off_is_off() -> None:
    off = {row.name: row.default for row in parameters.EFFECT_ROWS}
    plain, given = Tables("match-sensors-v0", 32, seed=3), Tables("match-sensors-v0", 32, seed=3, parameters=off)
    for actions in actions_of(plain, 200):
        plain.step(actions)
        given.step(actions)
        assert np.array_equal(plain.observations, given.observations)


def test_every_entry_point_takes_them(tmp_path: Path) -> None:
    file = tmp_path / "effects.toml"
    file.write_text('format = "puckpilot-effects/1"\n[effects.table_tilt]\ntilt_x = 0.1\ntilt_y = -0.05\n')
    for effects in (TILT, file, str(file)):
        environments = (
            pettingzoo.make("parallel", "puckpilot/match-v0", effects=effects).unwrapped.tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
            gymnasium.make("puckpilot/match-v0", effects=effects).unwrapped.tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
            gymnasium.make_vec("puckpilot/match-v0", num_envs=2, effects=effects).tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
            Tables("match-v0", 3, effects=effects),
        )
        for tables in environments:
            assert (tables.params["tilt_x"] == 0.1).all() and (tables.params["tilt_y"] == -0.05).all()
    assert Tables("match-v0", 1, effects=TILT, parameters={"tilt_x": 0.0}).params["tilt_x"] == 0.0


def test_a_resting_puck_runs_down_a_tilted_table() -> None:
    tables = Tables("match-v0", 1, effects={"table_tilt": {"tilt_y": 0.2}})
    tables.states["puck"][0] = (1.2, 0.3, 0.0, 0.0, 0.0, 0, (0, 0))
    stay = np.concatenate([tables.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
    for _ in range(10):
        tables.step(stay)
    assert tables.states["puck"]["y"][0] == pytest.approx(0.3 + 0.5 * (0.2 - 0.125), abs=1e-4)
    assert tables.states["puck"]["x"][0] == pytest.approx(1.2)


def test_a_puck_comes_to_rest_against_the_lower_wall() -> None:
    tables = Tables("match-v0", 1, effects={"table_tilt": {"tilt_y": 0.2, "tilt_x": -0.05}}, period=0.1)
    tables.states["puck"][0] = (0.5, 0.8, 0.3, 0.1, 0.0, 0, (0, 0))
    stay = np.concatenate([tables.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
    for _ in range(60):
        tables.step(stay)
    puck, p = tables.states["puck"][0], tables.params[0]
    assert puck["y"] == pytest.approx(p["width"] - p["puck_radius"], abs=1e-6)
    assert (puck["vx"], puck["vy"]) == (0.0, 0.0)


def test_air_drift_counts_from_the_begin_of_the_episode() -> None:
    """Friction (1 + t/100 s) from a start at 50 s: 1.5 times as much."""
    tables = Tables("match-v0", 1, effects={"air_drift": {"rate": 0.01}}, parameters={"drag": 0.0, "friction": 0.1})
    tables.states["steps"], tables.states["time"] = 500, 50.0
    tables.states["puck"][0] = (0.8, 0.3, 0.0, 0.5, 0.0, 0, (0, 0))
    stay = np.concatenate([tables.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
    tables.step(stay)
    assert tables.states["puck"]["vy"][0] == pytest.approx(0.5 - 0.1 * 0.1 * 1.5005, abs=1e-7)


def test_a_draw_on_an_effect_s_row_is_drawn_and_acts() -> None:
    draws = (Draw("tilt_y", "uniform", -0.2, 0.2, "a test"),)
    tables = Tables(
        replace(find_variant("match-v0"), draws=draws), 500, seed=1, parameters={"friction": 0.0, "drag": 0.0}
    )
    tilt = tables.params["tilt_y"].copy()
    assert tilt.min() < -0.15 and tilt.max() > 0.15 and np.unique(tilt).size == 500
    before = tables.states["puck"].copy()
    tables.step(actions_of(tables, 1)[0])
    after = tables.states["puck"]
    free = after["vx"] == before["vx"]  # no contact in this step
    assert free.sum() > 300
    np.testing.assert_allclose((after["vy"] - before["vy"])[free], 0.1 * tilt[free], atol=1e-12)


@pytest.mark.slow
def test_the_camera_sees_the_bent_path() -> None:
    """A frame shows where a copy of the table is at the frame's time."""
    clean: dict[str, float] = dict.fromkeys(
        ("camera_noise", "beam_noise", "camera_error", "beam_width", "dropped_frames", "held_frames"), 0.0
    )
    tables = Tables("match-sensors-v0", 8, seed=4, parameters=clean, effects=SOME)
    names = [column.name for column in tables.observation_columns]
    seen, frame_rate = names.index("puck_0_x"), 120.0
    for actions in actions_of(tables, 12):
        before = tables.snapshot()
        tables.step(actions)
        now, phase = tables.states["time"], tables.states["frame_phase"]
        latest = np.floor((now - tables.params["camera_latency"]) * frame_rate - phase + 1e-9)
        exposed = (latest + phase) / frame_rate
        past = Tables("match-sensors-v0", 8, seed=4, parameters=clean, effects=SOME)
        past.restore(before)
        for i in np.flatnonzero(tables.states["held"] > 0.1):
            (moment,), _ = trace(past, int(i), actions[i], [exposed[i] - before.states["time"][i]])
            expected = [moment["puck"]["x"], moment["puck"]["y"]]
            np.testing.assert_allclose(tables.observations[i, 0, seen : seen + 2], expected, atol=1e-5)


def test_a_turned_table_with_effects_plays_the_same_game() -> None:
    tables, turned = Tables("match-v0", 64, seed=2, effects=SOME), Tables("match-v0", 64, effects=SOME)
    for step, actions in enumerate(actions_of(tables, 60)):
        if step % 3 == 0:
            turned.restore(tables.snapshot())
            turned.turn()
        tables.step(actions)
        turned.step(actions[:, ::-1])
        np.testing.assert_allclose(turned.observations[:, ::-1], tables.observations, atol=1e-4)
        np.testing.assert_allclose(turned.rewards[:, ::-1], tables.rewards, atol=1e-4)


def test_spin_is_part_of_the_state_and_ends_with_a_new_start() -> None:
    tables = Tables("match-v0", 64, seed=2, effects=SOME)
    actions = actions_of(tables, 80)
    for some in actions[:40]:
        tables.step(some)
    assert (tables.states["puck"]["spin"] != 0.0).any()
    there = tables.snapshot()
    for some in actions[40:]:
        tables.step(some)
    end = tables.states.copy()
    tables.restore(there)
    for some in actions[40:]:
        tables.step(some)
    assert np.array_equal(tables.states, end)
    tables.reset()
    assert (tables.states["puck"]["spin"] == 0.0).all()


def test_pucks_stay_on_the_table_with_every_effect_on() -> None:
    tables = Tables("match-v0", 256, seed=7, effects=SOME, period=0.05)
    p = tables.params[0]
    for actions in actions_of(tables, 200):
        tables.step(actions)
        puck = tables.states["puck"]
        for name in ("x", "y", "vx", "vy", "spin"):
            assert np.isfinite(puck[name]).all()
        assert (puck["y"] >= p["puck_radius"]).all() and (puck["y"] <= p["width"] - p["puck_radius"]).all()
        assert (puck["x"] >= 0.0).all() and (puck["x"] <= p["length"]).all()
        assert np.hypot(puck["vx"], puck["vy"]).max() < 60.0


def test_a_scripted_player_is_told_the_refitted_baseline_but_no_effect() -> None:
    printed = Seat.from_tables(Tables("match-v0", 1, effects=SOME, parameters={"friction": 0.05})).parameters
    assert printed["friction"] == 0.05
    assert all(printed[row.name] == row.default for row in parameters.EFFECT_ROWS)
