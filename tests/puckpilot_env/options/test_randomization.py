"""Drawn parameters: in their ranges, with the right distributions, anew for each episode, and told in infos."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy import stats

from puckpilot_env import Tables, all_variants, find_variant, parameters
from puckpilot_env.adapters.infos import drawn_info
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.options.randomization import REALITY, Draw, as_rows

RANDOMIZED = [id_ for id_, variant in all_variants().items() if variant.draws]
NAMES = [draw.parameter for draw in REALITY]
COUNT = 4000


@pytest.fixture(scope="module")
def drawn() -> np.ndarray:
    """Parameter records of so many tables of one batch."""
    return Tables("defence-randomized-v0", COUNT, seed=11).params.copy()


def largest_correlation(rows: list[np.ndarray]) -> float:
    """The largest absolute one between different rows."""
    return float(np.abs(np.corrcoef(rows) - np.eye(len(rows))).max())


def test_three_variants_are_randomized():
    assert [id_.split("/")[1] for id_ in RANDOMIZED] == [
        "attack-randomized-v0",
        "defence-randomized-v0",
        "match-randomized-v0",
    ]


@pytest.mark.parametrize("draw", REALITY, ids=lambda draw: draw.parameter)
def test_range_and_distribution(drawn, draw):
    values = drawn[draw.parameter]
    assert draw.low <= values.min() and values.max() <= draw.high
    if draw.distribution == "log-uniform":
        share = np.log(values / draw.low) / np.log(draw.high / draw.low)
    else:
        share = (values - draw.low) / (draw.high - draw.low)
    assert stats.kstest(share, "uniform").pvalue > 1e-3


def test_drawn_independently(drawn):
    assert largest_correlation([drawn[name] for name in NAMES]) < 4.5 / np.sqrt(COUNT)


def test_all_else_keeps_its_default(drawn):
    for row in parameters.TABLE:
        if row.name not in NAMES:
            assert (drawn[row.name] == row.default).all(), row.name


def test_neither_side_nor_end_of_a_table_is_favoured():
    """What a left-right flip or a turn of the table changes the sign of is drawn evenly about none."""
    odd = {"tilt_x", "tilt_y", "warp_xy", "friction_turning", "side_force", "spin_side_force", "camera_shear"}
    odd |= {"restitution_x0", "restitution_x1", "restitution_y0", "restitution_y1", "patch_extra"}
    about_none = [draw for draw in REALITY if draw.parameter in odd]
    assert {draw.parameter for draw in about_none} == {"tilt_x", "tilt_y", "warp_xy"}
    assert all(draw.distribution == "uniform" and draw.low == -draw.high for draw in about_none)


def test_gantries_differ_by_their_spread():
    """Each player's gantry has numbers of its own, uniform within the table's spread, and works with them."""
    tables = Tables("match-randomized-v0", COUNT, seed=4)
    shares = (tables.states["gantry_scale"] - 1.0) / tables.params["gantry_spread"][:, None, None, None]
    shares = shares.reshape(COUNT, 12)
    for column in shares.T:
        assert stats.kstest(column, "uniform", (-1.0, 2.0)).pvalue > 1e-4
    assert largest_correlation(list(shares.T)) < 4.5 / np.sqrt(COUNT)
    p, state = tables.params[0], tables.states[0]
    for player in range(2):
        for axis, sign in enumerate((-1.0, 1.0)):
            c = [(p[f"a{i + 1}"] + sign * p[f"b{i + 1}"]) * state["gantry_scale"][player, axis, i] for i in range(3)]
            constants = state["mallets"]["xy"[axis]][player]
            np.testing.assert_allclose(constants["rest_gain"], 0.5 * p["pulley_radius"] / c[2], rtol=1e-12)
            poles = np.sort(-np.roots(c).real)
            np.testing.assert_allclose([constants["slow_rate"], constants["fast_rate"]], poles, rtol=1e-9)


def test_anew_for_each_episode():
    tables = Tables("attack-randomized-v0", 8, seed=4, max_cycles=3)
    home = np.tile(np.array([0.25, 0.5, 0.3, 0.3], np.float32), (8, 2, 1))
    before = tables.params.copy()
    for _ in range(2):
        tables.step(home)
        playing = tables.states["episode"] == 1
        assert (tables.params[playing] == before[playing]).all()
    tables.step(home)
    assert (tables.states["episode"] > 1).all()
    for name in NAMES:
        assert (tables.params[name] != before[name]).all(), name


@pytest.mark.parametrize("id_", RANDOMIZED)
def test_told_in_infos(id_):
    env = TableEnv(find_variant(id_))
    _, infos = env.reset(seed=3)
    p = env.tables.params[0]
    for k, agent in enumerate(env.possible_agents):
        assert infos[agent]["parameters"] == {name: float(p[name]) for name in NAMES}
        np.testing.assert_array_equal(infos[agent]["gantry_scale"], env.tables.states["gantry_scale"][0, k])
        late = infos[agent]["camera_delay"] - p["camera_latency"]
        assert 0.0 <= late <= 1.0 / p["frame_rate"]
    assert env.reset(seed=4)[1]["player_0"]["parameters"] != infos["player_0"]["parameters"]


def test_nothing_to_tell_without_draws():
    assert TableEnv(find_variant("match-v0")).reset(seed=3)[1] == {"player_0": {}, "player_1": {}}


def test_what_is_given_is_not_drawn():
    """Neither at first nor in later episodes; nor is it among what infos tell as drawn. The rest is drawn."""
    env = TableEnv(find_variant("match-randomized-v0"), parameters={"friction": 0.2, "drag": 0.01})
    for _ in range(3):
        _, infos = env.reset()
        assert env.tables.params["friction"][0] == 0.2 and env.tables.params["drag"][0] == 0.01
        assert set(infos["player_0"]["parameters"]) == set(NAMES) - {"friction", "drag"}


@pytest.mark.parametrize(
    "draw, expected",
    [
        (Draw("frictoin", "uniform", 0.1, 0.2, ""), r"unknown parameter 'frictoin'; did you mean 'friction'\?"),
        (
            Draw("friction", "normal", 0.1, 0.2, ""),
            "the draw of 'friction' has the unknown distribution 'normal'; known: ",
        ),
        (Draw("friction", "uniform", -0.1, 0.2, ""), r"parameter 'friction' is -0.1; expected a number in \[0, 5\]"),
        (Draw("friction", "uniform", 0.2, 0.1, ""), "the draw of 'friction' is from 0.2 to 0.1; expected low <= high"),
        (Draw("drag", "log-uniform", 0.0, 0.1, ""), "the draw of 'drag' is log-uniform from 0; expected low > 0"),
        (Draw("friction", "uniform", 0.1, 5.1, ""), r"parameter 'friction' is 5.1; expected a number in \[0, 5\]"),
    ],
)
def test_impossible_draws(draw, expected):
    with pytest.raises(ValueError, match=f"^{expected}"):
        as_rows((draw,))
    with pytest.raises(ValueError, match=f"^{expected}"):
        Tables(replace(find_variant("match-v0"), draws=(draw,)), 1)


def test_given_parameters_are_not_drawn():
    tables = Tables("match-randomized-v0", 16, seed=1, parameters={"friction": 0.2})
    assert (tables.params["friction"] == 0.2).all() and len(set(tables.params["drag"])) == 16
    assert "friction" not in drawn_info(tables, np.zeros(16, int))["parameters"]
