"""Draws from a file or a mapping: what they come to, beside what else is given, and what is refused, in one line."""

from __future__ import annotations

import tomllib
from dataclasses import replace
from pathlib import Path

import gymnasium
import numpy as np
import pettingzoo
import pytest
from scipy import stats

from puckpilot_env import Tables, find_variant
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.options.draws_file import described, read_draws
from puckpilot_env.options.randomization import REALITY, Draw

GOOD = """
format = "puckpilot-draws/1"

[parameters]
length = 2.362

[draws.friction]
distribution = "log-uniform"
low = 0.08
high = 0.1
source = "our table"

[draws.tilt_x]
low = -0.01
high = 0.02
"""
COUNT = 3000


def write(folder: Path, text: str) -> Path:
    path = folder / "draws.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_comes_to_rows_and_parameters(tmp_path: Path) -> None:
    for given in (write(tmp_path, GOOD), str(write(tmp_path, GOOD)), tomllib.loads(GOOD)):
        expected = read_draws(given)
        assert expected.parameters == {"length": 2.362}
        assert expected.draws == (
            Draw("friction", "log-uniform", 0.08, 0.1, ""),
            Draw("tilt_x", "uniform", -0.01, 0.02, ""),
        )
        assert [draw.source for draw in expected.draws] == ["our table", ""]
        assert read_draws(expected.as_dict()) == expected
    assert read_draws({"friction": {"low": 0, "high": 1}}).draws == (Draw("friction", "uniform", 0.0, 1.0, ""),)
    assert read_draws(None) == read_draws({}) == read_draws({"format": "puckpilot-draws/1"})


def test_a_file_is_told_in_lines(tmp_path: Path) -> None:
    path = write(tmp_path, GOOD)
    lines = ["drawn for every episode: friction 0.08 to 0.1, tilt_x -0.01 to 0.02"]
    assert described(path) == [*lines, "nominal, in place of the defaults: length 2.362"]
    assert described(path, ["length", "friction"]) == ["drawn for every episode: tilt_x -0.01 to 0.02"]


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ("puckpilot-draws/1", "puckpilot-effects/1", "format is 'puckpilot-effects/1'; expected the line"),
        ('format = "puckpilot-draws/1"', "", "there is no line with its format; expected the line"),
        ("[parameters]", "[paramters]", "unknown entry 'paramters'; did you mean 'parameters'?"),
        ("draws.friction", "draws.frictoin", "unknown parameter 'frictoin'; did you mean 'friction'?"),
        ("low = 0.08", "lwo = 0.08", "unknown key of draws.friction 'lwo'; did you mean 'low'?"),
        ("low = 0.08", "", "draws.friction has no low; expected numbers low and high"),
        ("low = 0.08", "low = 0.11", "the draw of 'friction' is from 0.11 to 0.1; expected low <= high"),
        ("low = 0.08", "low = 0", "the draw of 'friction' is log-uniform from 0; expected low > 0"),
        ("low = 0.08", "low = -0.1", "parameter 'friction' is -0.1; expected a number in [0, 5] m/s^2"),
        ("high = 0.1", "high = 5.1", "parameter 'friction' is 5.1; expected a number in [0, 5] m/s^2"),
        ("high = 0.1", "high = inf", "parameter 'friction' is inf; expected a number in [0, 5] m/s^2"),
        ("low = 0.08", "low = nan", "parameter 'friction' is nan; expected a number in [0, 5] m/s^2"),
        ("low = 0.08", f"low = 1{'0' * 400}", "expected a number in [0, 5] m/s^2"),
        ("low = 0.08", 'low = "0.08"', "parameter 'friction' is '0.08'; expected a number"),
        ("high = 0.1", "high = true", "parameter 'friction' is True; expected a number"),
        ("log-uniform", "normal", "unknown distribution 'normal'; known: uniform, log-uniform"),
        ('"log-uniform"', "3", "distribution of draws.friction is 3; expected a text"),
        ('"our table"', "1.5", "source of draws.friction is 1.5; expected a text"),
        (
            "[draws.tilt_x]\nlow = -0.01\nhigh = 0.02",
            "[draws]\ntilt_x = 0.02",
            "draws.tilt_x is 0.02; expected numbers",
        ),
        ("draws.tilt_x]\nlow = -0.01", "draws.encoder_clock]\nlow = 0", "no table can be given clock_drift: "),
        ("draws.tilt_x", "draws.unlisted_00", "'unlisted_00' cannot be drawn: it is one of a table of numbers of"),
        ("length = 2.362", "encoder_clock = 100.0", "no table can be given clock_drift: "),
        ("length = 2.362", "length = 5", "parameter 'length' is 5; expected a number in [1, 4] m"),
        ("high = 0.02", "high = ", "line"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    path = write(tmp_path, GOOD.replace(old, new, 1))
    with pytest.raises(ValueError) as refusal:
        read_draws(path)
    assert str(refusal.value).startswith(f"{path}: ") and expected in str(refusal.value)
    assert "\n" not in str(refusal.value)
    with pytest.raises(ValueError):
        Tables("match-v0", 1, draws=path)


@pytest.mark.parametrize("how", ["missing", "folder", "picture"])
def test_what_is_no_such_file_is_refused(tmp_path: Path, how: str) -> None:
    path = tmp_path if how == "folder" else tmp_path / "file.toml"
    if how == "picture":
        path.write_bytes(b"\x89PNG\r\n\xff\xfe")
    with pytest.raises(ValueError, match=str(path)) as refusal:
        read_draws(path)
    assert "\n" not in str(refusal.value)


def test_tables_draw_what_the_file_says(tmp_path: Path) -> None:
    """By the distributions of another library; all else of a variant that draws nothing stays as it is."""
    p = Tables("defence-v0", COUNT, seed=7, draws=write(tmp_path, GOOD)).params
    assert stats.kstest(p["friction"], stats.loguniform(0.08, 0.1).cdf).pvalue > 1e-3
    assert stats.kstest(p["tilt_x"], stats.uniform(-0.01, 0.03).cdf).pvalue > 1e-3
    assert (p["length"] == 2.362).all() and (p["drag"] == 0.125).all() and (p["tilt_y"] == 0.0).all()


def test_the_file_s_rows_take_the_place_of_the_variant_s() -> None:
    tables = Tables(
        "match-randomized-v0", 200, draws={"friction": {"low": 0.3, "high": 0.4}, "post_extra": {"low": 0, "high": 0}}
    )
    names = [draw.parameter for draw in tables.variant.draws]
    assert names == [d.parameter for d in REALITY if d.parameter != "friction"] + ["friction", "post_extra"]
    assert tables.params["friction"].min() > 0.3 and (tables.params["post_extra"] == 0.0).all()
    assert len(set(tables.params["drag"])) == 200


def test_infos_tell_what_a_file_draws() -> None:
    env = TableEnv(find_variant("match-v0"), draws={"tilt_y": {"low": 0.01, "high": 0.02}})
    _, infos = env.reset(seed=3)
    assert infos["player_1"]["parameters"] == {"tilt_y": float(env.tables.params["tilt_y"][0])}
    assert 0.01 < infos["player_1"]["parameters"]["tilt_y"] < 0.02


def test_libraries_make_environments_with_draws() -> None:
    draws = {"tilt_y": {"low": 0.01, "high": 0.02}}
    made = (
        pettingzoo.make("parallel", "puckpilot/match-v0", draws=draws).unwrapped.tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
        gymnasium.make("puckpilot/match-v0", draws=draws).unwrapped.tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
        gymnasium.make_vec("puckpilot/match-v0", 3, draws=draws).unwrapped.tables,  # pyright: ignore[reportAttributeAccessIssue] - the unwrapped one has tables
    )
    for tables in made:
        assert [draw.parameter for draw in tables.variant.draws] == ["tilt_y"]
        assert (tables.params["tilt_y"] > 0.01).all()


def test_parameters_win_over_draws_and_draws_over_effects() -> None:
    """An effect's number that is drawn all the same is what players may know of it."""
    draws = {"tilt_x": {"low": 0.01, "high": 0.02}, "friction": {"low": 0.1, "high": 0.2}}
    effects = {"table_tilt": {"tilt_x": 0.015, "tilt_y": 0.004}}
    tables = Tables("match-randomized-v0", 50, draws=draws, effects=effects, parameters={"friction": 0.13})
    assert (tables.params["friction"] == 0.13).all() and (tables.params["tilt_y"] == 0.004).all()
    assert len(set(tables.params["tilt_x"])) == 50 and tables.nominal["tilt_x"] == 0.015
    assert not {"friction", "tilt_y"} & {draw.parameter for draw in tables.variant.draws}


def test_nominal_numbers_lie_in_the_range() -> None:
    """Where nobody says otherwise: the default, or the median of a range that leaves it out."""
    draws = {
        "friction": {"distribution": "log-uniform", "low": 0.01, "high": 0.04},
        "drag": {"low": 0.1, "high": 0.2},
        "wall_restitution": {"low": 0.8, "high": 0.9},
    }
    nominal = Tables("match-v0", 1, draws=draws).nominal[0]
    assert nominal["friction"] == pytest.approx(0.02) and nominal["drag"] == 0.125
    assert nominal["wall_restitution"] == pytest.approx(0.85)
    expected = {"format": "puckpilot-draws/1", "parameters": {"wall_restitution": 0.82}, "draws": draws}
    assert Tables("match-v0", 1, draws=expected).nominal["wall_restitution"] == 0.82


def test_frames_are_kept_for_the_latest_camera() -> None:
    """As many as if every camera were the latest and fastest that may be drawn."""
    draws = {"camera_latency": {"low": 0.01, "high": 0.06}, "frame_rate": {"low": 100, "high": 300}}
    worst = {"camera_latency": 0.06, "frame_rate": 300.0}
    drawn, given = Tables("match-sensors-v0", 1, draws=draws), Tables("match-sensors-v0", 1, parameters=worst)
    plain = Tables("match-sensors-v0", 1)
    kept = [tables.snapshot().frames.shape[1] for tables in (drawn, given, plain)]
    assert kept[0] == kept[1] > kept[2]


def ranges(**each: tuple[float, float]) -> dict[str, dict[str, float]]:
    return {name: {"low": low, "high": high} for name, (low, high) in each.items()}


@pytest.mark.parametrize(
    "draws, expected",
    [  # with all numbers low, and with all high, the first three are fine
        (ranges(width=(0.56, 0.64), mallet_radius=(0.05, 0.1)), "the table is too small: .*; drawn are width 0.56, "),
        (ranges(a2=(0.0055, 0.02), a3=(0.05, 2.0)), "gantry axis y is not overdamped: .*; drawn are a2 0.0055, a3 2$"),
        (ranges(gantry_spread=(0.0, 0.3), a2=(0.004, 0.02), a3=(0.05, 0.3)), "gantry axis y cannot .*; drawn .*0.3$"),
        (ranges(command_delay=(0.0, 0.05)), "command_delay is 0.05 s; expected less than the period of 0.05 s$"),
        (ranges(length=(1.96, 2.06)), r"the draw of 'length' is from 1.96 to 2.06; expected within 0.05 m of the nom"),
        (ranges(width=(0.5, 0.6)), "the draw of 'width' is from 0.5 to 0.6; expected within 0.05 m of the nominal 0.6"),
    ],
)  # fmt: skip
def test_what_makes_no_table_together_is_refused(draws: dict[str, dict[str, float]], expected: str) -> None:
    content = {"format": "puckpilot-draws/1", "parameters": {"width": 0.6, "goal_width": 0.2}, "draws": draws}
    with pytest.raises(ValueError, match=f"^{expected}") as refusal:
        Tables("match-v0", 1, period=0.05, draws=content)
    assert "\n" not in str(refusal.value)


def test_what_players_are_shown_in_shares_of_is_not_drawn() -> None:
    draws = ranges(a3=(0.05, 0.06))
    assert len(set(Tables("match-v0", 20, draws=draws).params["a3"])) == 20
    with pytest.raises(ValueError, match=r"^a3 cannot be drawn: players are shown .*; draw gantry_spread, or give it"):
        Tables("match-randomized-v0", 1, draws=draws)
    shown = replace(find_variant("match-v0"), shows_gantry=True)
    Tables(shown, 1, draws=ranges(gantry_spread=(0.0, 0.05)), parameters={"a3": 0.055})
    with pytest.raises(ValueError, match=r"^a3 cannot be drawn"):
        Tables(shown, 1, draws=draws)


def test_every_drawn_table_is_one_that_could_be_given() -> None:
    """What is accepted at its corners holds inside: parameters of drawn tables make a table when they are given."""
    drawn = Tables("match-randomized-v0", 40, seed=5)
    names = [draw.parameter for draw in drawn.variant.draws]
    for row in drawn.params:
        Tables("match-v0", 1, parameters={name: float(row[name]) for name in names})
    assert np.ptp(drawn.params["length"]) > 0.004


def test_a_number_that_is_whole_cannot_be_drawn() -> None:
    with pytest.raises(ValueError, match="hand cannot be drawn, for it has whole numbers alone; give it"):
        read_draws({"hand": {"low": 0.0, "high": 1.0}})
