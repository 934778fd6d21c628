"""What each arm learns on, from the files of a diagnosis."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from puckpilot_env import Tables
from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.options.draws_file import read_draws
from puckpilot_env.options.effects_file import as_content, effect_values
from sim2real.gap.arms import ARMS, HELD, Delays, simulator_of, write_simulator
from sim2real.gap.gap_table import TWIN, GapTable, find_gap_table
from sim2real.table.board_config import MOST_COMMAND_DELAY
from sim2real.table.twin.concealed import TABLES

EFFECTS = """format = "puckpilot-effects/1"
[parameters]
friction = 0.1
[effects.table_tilt]
tilt_x = 0.03
tilt_y = 0.0
[effects.command_delay]
delay_s = 0.004
"""
DRAWS = """format = "puckpilot-draws/1"
[parameters]
command_delay = 0.004
tilt_x = 0.03
[draws.friction]
low = 0.09
high = 0.11
[draws.command_delay]
low = 0.003
high = 0.005
"""


def twin(table: str) -> GapTable:
    return find_gap_table(TWIN, table)


@pytest.fixture
def circle(tmp_path: Path) -> Path:
    late = [
        {"mechanism": name, "parameters": {"delay_s": {"value": value}}}
        for name, value in (("camera_delay", 0.01), ("command_delay", 0.004))
    ]
    found = {"baseline": {"parameters": {"friction": {"value": 0.1}}}, "findings": late}
    (tmp_path / "diagnosis").mkdir()
    (tmp_path / "before" / "recordings" / "game_0").mkdir(parents=True)
    for name, text in (("effects.toml", EFFECTS), ("draws.toml", DRAWS), ("diagnosis.json", json.dumps(found))):
        (tmp_path / "diagnosis" / name).write_text(text)
    return tmp_path


def test_the_corrected_arm_has_what_was_found_and_its_loop_allows_for_delays(circle: Path) -> None:
    one = simulator_of("corrected", circle, twin("none"))
    assert one is not None and one.draws is not None
    assert dict(one.values) == {"friction": 0.1, "tilt_x": 0.03, "tilt_y": 0.0, **AT_TABLE}
    assert set(one.draws["draws"]) == {"friction"}
    allowed = {arm: row.delays(circle, twin("late")) for arm, row in ARMS.items()}
    late = TABLES["late"]
    assert {arm: delays for arm, delays in allowed.items() if delays != Delays()} == {
        "allowing": Delays(0.01, 0.004), "corrected": Delays(0.01, 0.004),
        "truth": Delays(late.errors.stamp_late, late.law["command_delay"]),
    }  # fmt: skip


def test_a_delay_beyond_what_a_board_allows_for_is_allowed_for_as_far_as_it_can(circle: Path) -> None:
    file = circle / "diagnosis" / "diagnosis.json"
    file.write_text(file.read_text().replace("0.004", "0.04"))
    assert ARMS["corrected"].delays(circle, twin("none")) == Delays(0.01, MOST_COMMAND_DELAY)


def test_without_recordings_there_is_no_black_box(circle: Path) -> None:
    (circle / "before" / "recordings" / "game_0").rmdir()
    with pytest.raises(ValueError, match="before has no recordings, to which a network could be fitted"):
        simulator_of("residual", circle, twin("warp"))


def test_others_do_not_see_the_findings(circle: Path) -> None:
    made = {arm: simulator_of(arm, circle, twin("warp")) for arm in ARMS}
    values = {arm: dict(one.values) for arm, one in made.items() if one}
    assert made.keys() - values.keys() == {"allowing"}
    networks = {arm: one.residual_of for arm, one in made.items() if one and one.residual_of}
    assert networks == {"residual": (circle / "before" / "recordings" / "game_0",)} and values["residual"] == AT_TABLE
    assert values["unchanged"] == AT_TABLE
    assert values["constants"] == {"friction": 0.1, **AT_TABLE}
    assert values["truth"]["tilt_x"] == TABLES["warp"].truth["tilt_x"]


def test_late_commands_are_not_learnt_on_and_friction_is_beside_a_board_s_feedback(circle: Path) -> None:
    late, friction = (simulator_of("truth", circle, twin(table)) for table in ("late", "friction"))
    assert TABLES["late"].truth.keys() == set(HELD) and late is not None and late.values == AT_TABLE
    assert friction is not None and friction.values == {**TABLES["friction"].truth, **AT_TABLE}
    assert AT_TABLE["feedback_voltage"] > 0.0


@pytest.mark.parametrize("table", TABLES)
def test_every_arm_can_be_learnt_on(circle: Path, table: str) -> None:
    for arm in ARMS:
        one = simulator_of(arm, circle, twin(table))
        if one is None or one.residual_of:  # this one needs recordings: test_residual.py
            continue
        tables = Tables("match-v0", 2, effects=as_content(one.values), draws=one.draws)
        assert not any(tables.params[name].any() for name in HELD) and (tables.params["hand"] == 1.0).all()
        (circle / arm).mkdir()
        files = write_simulator(one, circle / arm)
        assert effect_values(files["effects"]) == one.values
        assert read_draws(files.get("draws")) == read_draws(one.draws)


def test_an_unknown_arm_is_refused_in_one_line(circle: Path) -> None:
    with pytest.raises(ValueError, match="unknown arm 'corected'"):
        simulator_of("corected", circle, twin("none"))
