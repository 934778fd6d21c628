"""Batches: a table plays the same in any company, can be saved and forked, and refuses bad actions untouched."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from puckpilot_env import Tables, batch, find_variant
from puckpilot_env.infos import drawn_info
from puckpilot_env.randomization import Draw
from puckpilot_env.trace import trace

NAMES = ("observations", "rewards", "terminated", "truncated")
SHORT = ["match-randomized-v0", "match-v0", "defence-randomized-v0", "attack-v0"]


def actions_for(tables: Tables, steps: int, seed: int = 5) -> np.ndarray:
    """`(steps, n, 2, 4)` random actions."""
    low, high = tables.action_bounds
    return np.random.default_rng(seed).uniform(low, high, (steps, len(tables), 2, 4)).astype(np.float32)


def outputs(tables: Tables, rows: Any = slice(None)) -> dict[str, np.ndarray]:
    """Everything of these rows that a step writes, states and parameters included, as copies."""
    found = {name: getattr(tables, name)[rows].copy() for name in (*NAMES, "states", "params")}
    ended = (tables.terminated | tables.truncated)[rows]
    found["finals"] = tables.final_observations[rows][ended].copy()
    return found


def assert_same(a: dict[str, np.ndarray], b: dict[str, np.ndarray]) -> None:
    for name, array in a.items():
        assert array.tobytes() == b[name].tobytes(), name


@pytest.mark.parametrize("variant", SHORT)
def test_alone_or_among_8192(variant):
    """Streams depend on the table's index, so the lone table is taken out of the crowd and played beside it."""
    crowd = Tables(variant, 8192, seed=3, max_cycles=15)
    picked = [0, 17, 8191]
    alone = [Tables(variant, 1, seed=9, max_cycles=15) for _ in picked]
    for table, i in zip(alone, picked, strict=True):
        table.restore(crowd.snapshot([i]))
    episodes = crowd.states["episode"][picked].copy()
    for actions in actions_for(crowd, 40):
        crowd.step(actions)
        for table, i in zip(alone, picked, strict=True):
            table.step(actions[[i]])
            assert_same(outputs(table), outputs(crowd, [i]))
    assert (crowd.states["episode"][picked] >= episodes + 2).all()  # through automatic resets


@pytest.mark.parametrize("variant", SHORT)
def test_the_first_tables_of_a_batch_do_not_depend_on_its_size(variant):
    few, many = Tables(variant, 3, seed=3), Tables(variant, 50, seed=3)
    for actions in actions_for(many, 30):
        few.step(actions[:3])
        many.step(actions)
        assert_same(outputs(few), outputs(many, slice(3)))


@pytest.mark.parametrize("variant", SHORT)
def test_one_thread_or_more(variant):
    one, two, three = (Tables(variant, 500, seed=3, threads=n, max_cycles=15) for n in (1, 2, 3))
    for actions in actions_for(one, 40):
        for tables in (one, two, three):
            tables.step(actions)
        assert_same(outputs(one), outputs(two))
        assert_same(outputs(one), outputs(three))
    two.close()
    three.close()


@pytest.mark.parametrize("tables, threads", [(1, 1), (5, 3), (500, 2), (2048, 2), (8191, 16)])
def test_threads_share_all_tables(tables, threads):
    """Ranges join up and are taken by size; the last ones are a small part of what a thread does."""
    ranges = batch.ranges(tables, threads)
    assert [a for a, _ in ranges] + [tables] == [0] + [b for _, b in ranges]
    sizes = [b - a for a, b in ranges]
    assert min(sizes) > 0 and sizes == sorted(sizes, reverse=True)
    if tables >= 1000:
        assert len(sizes) > 2 * threads and sizes[-1] <= 0.1 * tables / threads + 64


@pytest.mark.parametrize("variant", SHORT)
def test_restore_plays_the_same_again(variant):
    """Through automatic resets, random streams and drawn parameters included."""
    tables = Tables(variant, 16, seed=1, max_cycles=12)
    script = actions_for(tables, 45)
    for actions in script[:10]:
        tables.step(actions)
    saved = tables.snapshot()
    first = []
    for actions in script[10:]:
        tables.step(actions)
        first.append(outputs(tables))
    tables.reset(77)
    tables.restore(saved)
    assert tables.observations.tobytes() == saved.observations.tobytes()
    for actions, before in zip(script[10:], first, strict=True):
        tables.step(actions)
        assert_same(before, outputs(tables))


@pytest.mark.parametrize("variant", SHORT)
def test_restoring_one_leaves_the_others(variant):
    tables = Tables(variant, 4, seed=1, max_cycles=12)
    script = actions_for(tables, 30)
    saved = tables.snapshot([2])
    for actions in script[:13]:
        tables.step(actions)
    others = tables.snapshot([0, 1, 3])
    tables.restore(saved, [2])
    assert tables.snapshot([2]).states.tobytes() == saved.states.tobytes()
    kept = tables.snapshot([0, 1, 3])
    for name in ("states", "params", "frames", "observations"):
        assert getattr(kept, name).tobytes() == getattr(others, name).tobytes()


@pytest.mark.parametrize("variant", SHORT)
def test_fork(variant):
    """All tables become one, and stay alike under alike actions; under others they part."""
    tables = Tables(variant, 8, seed=1, max_cycles=12)
    script = actions_for(tables, 30)
    for actions in script[:5]:
        tables.step(actions)
    tables.restore(tables.snapshot([3]))
    for actions in script[5:]:
        tables.step(np.broadcast_to(actions[:1], actions.shape))
        for i in range(1, 8):
            assert_same(outputs(tables, [0]), outputs(tables, [i]))
    tables.step(script[0])
    assert len({row.tobytes() for row in tables.observations}) == 8


def test_restore_refuses_what_does_not_fit():
    match, drill = Tables("match-v0", 2), Tables("defence-v0", 2)
    with pytest.raises(ValueError, match="another variant or camera"):
        match.restore(drill.snapshot())
    with pytest.raises(ValueError, match="snapshot has 2 tables; expected 1 or 3"):
        Tables("match-v0", 3).restore(match.snapshot())


@pytest.mark.parametrize("variant", ["match-randomized-v0", "attack-v0", "match-sensors-v0"])
def test_final_observations_are_the_ended_ones(variant):
    """What a batch keeps of an episode's end is what a batch without automatic reset shows there."""
    going, stopping = Tables(variant, 32, seed=2, max_cycles=9), Tables(variant, 32, autoreset=False, max_cycles=9)
    ends = 0
    for actions in actions_for(going, 30):
        stopping.restore(going.snapshot())
        going.step(actions)
        stopping.step(actions)
        ended = going.terminated | going.truncated
        assert (ended == (stopping.terminated | stopping.truncated)).all()
        assert going.final_observations[ended].tobytes() == stopping.observations[ended].tobytes()
        assert going.observations[~ended].tobytes() == stopping.observations[~ended].tobytes()
        assert (going.final_observations[ended] != going.observations[ended]).any(axis=(1, 2)).all()
        assert (going.states["steps"][ended] == 0).all()
        ends += int(ended.sum())
    assert ends >= 90


HIGHEST = np.finfo(np.float32).max


@pytest.mark.parametrize(
    "column, number, told",
    [
        (0, np.nan, "action target_x of player_1 on table 2 is nan; expected a number in [0.0505, 0.9495] m"),
        (1, np.inf, "action target_y of player_1 on table 2 is inf; expected a number in [0.0505, 0.9495] m"),
        (2, 10.00001, "action volts_x of player_1 on table 2 is 10.00001; expected a number in [0.3, 10] V"),
        (3, -HIGHEST, "action volts_y of player_1 on table 2 is -3.4028235e+38; expected a number in [0.3, 10] V"),
    ],
)
@pytest.mark.parametrize("variant", ["match-randomized-v0", "defence-v0"])
def test_bad_actions_change_nothing(variant, column, number, told):
    tables = Tables(variant, 4, seed=1)
    script = actions_for(tables, 4)
    for actions in script:
        tables.step(actions)
    before, frames = outputs(tables), tables.snapshot().frames
    script[-1, 2, 1, column] = number
    with pytest.raises(ValueError) as refusal:
        tables.step(script[-1])
    assert str(refusal.value) == told
    assert_same(before, outputs(tables))
    assert frames.tobytes() == tables.snapshot().frames.tobytes()


@pytest.mark.parametrize("side", [0, 1])
def test_actions_that_rounding_took_out_of_the_space_are_played_at_its_edge(side):
    """As gymnasium's RescaleAction makes them, in float32."""
    edge, beyond = (Tables("match-v0", 1, seed=2) for _ in range(2))
    actions = np.broadcast_to(edge.action_bounds[side], (1, 2, 4)).astype(np.float32)
    off = np.nextafter(actions, np.float32(-1e9 if side == 0 else 1e9))
    assert not np.array_equal(actions, off)
    for _ in range(5):
        edge.step(actions)
        beyond.step(off)
    np.testing.assert_allclose(beyond.observations, edge.observations, atol=1e-5)


@pytest.mark.parametrize("shape", [(4, 2), (4, 2, 3), (3, 2, 4), (2, 4, 4), (32,), ()])
def test_wrong_shapes_change_nothing(shape):
    tables = Tables("match-v0", 4, seed=1)
    before = outputs(tables)
    with pytest.raises(ValueError, match="expected") as refusal:
        tables.step(np.full(shape, 0.5, np.float32))
    assert str(refusal.value) == f"actions have shape {shape or (1,)}; expected (4, 2, 4)"
    assert_same(before, outputs(tables))


@pytest.mark.parametrize("period", [1 / 120, 0.02, 0.1, 1.0])
@pytest.mark.parametrize("variant", SHORT)
def test_periods(variant, period):
    """Time passes as the period says, and what is seen stays in its space."""
    tables = Tables(variant, 8, seed=1, period=period)
    low, high = tables.observation_bounds
    begun = tables.states["episode"].copy()
    for n, actions in enumerate(actions_for(tables, 60), start=1):
        tables.step(actions)
        assert (tables.observations >= low).all() and (tables.observations <= high).all()
        assert np.isfinite(tables.rewards).all()
        first = tables.states["episode"] == begun
        np.testing.assert_allclose(tables.states["time"][first], n * period, rtol=1e-12)
    limit = find_variant(variant).step_limit
    assert tables.variant.step_limit == round(limit * 0.1 / period)


def test_a_finer_period_is_the_same_table():
    """A puck that nobody touches is after 1 s where it is after 10 or 120 steps."""
    places = []
    for period in (1 / 120, 0.1, 0.5):
        tables = Tables("match-v0", 16, seed=4, period=period, parameters={"mallet_radius": 0.02})
        home = tables.observations[:, :, :2]
        stay = np.concatenate([home, np.full((16, 2, 2), 0.3, np.float32)], axis=2)
        for _ in range(round(1.0 / period)):
            tables.step(stay)
        names = [column.name for column in tables.observation_columns]
        places.append(tables.observations[:, 0, names.index("puck_x") : names.index("puck_y") + 1].copy())
    np.testing.assert_allclose(places[0], places[1], atol=1e-5)
    np.testing.assert_allclose(places[0], places[2], atol=1e-5)


@pytest.mark.parametrize(
    "options, told",
    [
        ({"tables": 0}, "tables is 0; expected a whole number from 1"),
        ({"threads": 0}, "threads is 0; expected a whole number from 1 to 256"),
        ({"period": 0.008}, "period is 0.008; expected a number of seconds from 1/120 to 1"),
        ({"max_cycles": 0}, "limit of steps is 0; expected a whole number from 1"),
        ({"seed": -1}, r"seed is -1; expected a whole number from 0 to 2\*\*64 - 1"),
        ({"variant": "mach-v0"}, "unknown variant 'mach-v0'; did you mean 'puckpilot/match-v0'?"),
    ],
)
def test_what_cannot_be_is_refused(options, told):
    with pytest.raises(ValueError, match=told.replace("?", r"\?")):
        Tables(**{"variant": "match-v0", "tables": 1, **options})


@pytest.mark.parametrize("frame_rate", [10.0, 120.0, 300.0])
@pytest.mark.parametrize("period", [1 / 120, 0.1, 0.55, 1.0])
@pytest.mark.parametrize("variant", ["match-sensors-v0", "match-randomized-v0"])
def test_the_newest_frame_shows_the_table_as_it_was(variant, period, frame_rate):
    """Without noise, it is where a puck that nobody touches was `age` ago, however many frames a step has."""
    clean = ("camera_noise", "beam_noise", "camera_error", "dropped_frames", "held_frames", "beam_width")
    given = {"frame_rate": frame_rate, "camera_latency": 0.06, "mallet_radius": 0.02, **dict.fromkeys(clean, 0.0)}
    known = find_variant(variant)
    tables = Tables(replace(known, draws=()), 8, seed=4, period=period, parameters=given)
    names = [column.name for column in tables.observation_columns]
    seen = names.index("puck_0_x" if variant == "match-sensors-v0" else "puck_x")
    stay = np.concatenate([tables.observations[:, :, :2], np.full((8, 2, 2), 0.3, np.float32)], axis=2)
    for _ in range(max(1, round(1.0 / period))):
        tables.step(stay)
    now, phase = tables.states["time"], tables.states["frame_phase"]
    exposed = (np.floor((now - 0.06) * frame_rate - phase + 1e-9) + phase) / frame_rate
    for i in range(8):
        past = Tables(replace(known, draws=()), 8, seed=4, period=1 / 120, parameters=given)
        for _ in range(int(exposed[i] * 120)):
            past.step(stay)
        (moment,), _ = trace(past, i, stay[i], [exposed[i] - past.states["time"][i]])
        expected = [moment["puck"]["x"], moment["puck"]["y"]]
        np.testing.assert_allclose(tables.observations[i, 0, seen : seen + 2], expected, atol=1e-5)


def test_the_told_camera_delay_is_that_of_the_first_observation():
    """A puck that comes straight is seen `camera_delay` times its velocity before the place where it is."""
    clean = dict.fromkeys(
        ("camera_noise", "beam_noise", "camera_error", "beam_width", "dropped_frames", "held_frames"), 0.0
    )
    known = find_variant("match-randomized-v0")
    draws = tuple(draw for draw in known.draws if draw.parameter not in clean)
    for latency in (0.0, 0.0134, 0.06):
        given = {**clean, "camera_latency": latency}
        tables = Tables(replace(known, draws=draws), 200, seed=2, parameters=given)
        names = [column.name for column in tables.observation_columns]
        puck = tables.states["puck"]
        seen = tables.observations[:, 0, names.index("puck_x")]
        told = drawn_info(tables, np.zeros(200, int))["camera_delay"]
        np.testing.assert_allclose((puck["x"] - seen) / puck["vx"], told, atol=1e-5)
        assert told.min() >= latency - 1e-9 and told.max() <= latency + 1 / 120


@pytest.mark.parametrize(
    "draw, told",
    [
        (
            Draw("drag", "log-uniform", 0.0, 0.2, ""),
            "log-uniform from 0; expected low > 0",
        ),
        (Draw("drag", "uniform", 0.2, 0.1, ""), "draw of 'drag' is from 0.2 to 0.1; expected low <= high"),
        (Draw("drag", "normal", 0.1, 0.2, ""), "unknown distribution 'normal'"),
    ],
)
def test_draws_that_cannot_be_are_refused(draw, told):
    with pytest.raises(ValueError, match=told):
        Tables(replace(find_variant("match-v0"), draws=(draw,)), 1)


def test_a_spread_that_makes_a_gantry_swing_is_refused():
    """Poles are real as long as C6^2 > 4 C5 C7, for the worst of the drawn coefficients too."""
    slow = {"a1": 3e-4, "b1": 0.0}  # y: C6^2 / (4 C5 C7) = 0.138; x likewise 1.12
    with pytest.raises(ValueError, match="not overdamped"):
        Tables("match-v0", 1, parameters=slow)
    nearly = {"a1": 3e-5, "b1": 0.0}  # y: 1.38, and with 20 % of spread 0.61
    Tables("match-v0", 1, parameters=nearly)
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables("match-v0", 1, parameters={**nearly, "gantry_spread": 0.2})
    drawn = replace(find_variant("match-v0"), draws=(Draw("gantry_spread", "uniform", 0.0, 0.2, ""),))
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables(drawn, 1, parameters=nearly)


def test_given_parameters_are_not_drawn():
    tables = Tables("match-randomized-v0", 16, seed=1, parameters={"friction": 0.2})
    assert (tables.params["friction"] == 0.2).all() and len(set(tables.params["drag"])) == 16
    assert "friction" not in drawn_info(tables, np.zeros(16, int))["parameters"]


def test_a_held_frame_repeats_the_one_before():
    """So a velocity, a difference over two frames, is of half the way where the newer one is held, of 3/2 where the
    older one is; twice in a row is rarer."""
    clean = ("camera_noise", "beam_noise", "camera_error", "dropped_frames", "beam_width", "friction", "drag")
    values = {**dict.fromkeys(clean, 0.0), "held_frames": 0.05}
    tables = Tables(replace(find_variant("defence-randomized-v0"), draws=()), 2000, seed=1, parameters=values)
    column = [column.name for column in tables.observation_columns].index("puck_vx")
    stay = np.concatenate([tables.observations[:, :, :2], np.full((2000, 2, 2), 0.3, np.float32)], axis=2)
    before = tables.states["puck"]["vx"].copy()
    for _ in range(2):
        tables.step(stay)
    free = (tables.states["puck"]["vx"] == before) & (tables.states["steps"] == 2)
    ratios = (tables.observations[:, 0, column] / before)[free].round(3)
    assert len(ratios) > 300
    assert ((ratios == 0.5) | (ratios == 1.5)).mean() == pytest.approx(0.09, abs=0.04)
    assert (ratios > 2.0).mean() < 0.005
