"""The stages of a circle: each is run once, on what those before it made."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from agents.training.run_folder import RunFolder
from puckpilot import main
from puckpilot_env.options.at_table import AT_TABLE
from sim2real.gap import film, tuning
from sim2real.gap.circle import Circle
from sim2real.gap.circle_folder import Conditions, keep_conditions, keep_training
from sim2real.table import meetings
from tests.agents.training.tiny import TINY
from tests.sim2real.gap.test_against_truth import finding

PLAYED = {"scored", "conceded", "net", "against", "shots", "stops", "games"}
CONDITIONS = Conditions("interceptor", ("bank_shot", "goalie"), "twin", "none", 2, 12.0, 1, 1.0, None, 5)


def circle(folder: Path, **other: object) -> Circle:
    return Circle(folder, replace(CONDITIONS, **other), 1, lambda line: None)


@pytest.fixture(autouse=True)
def short_films(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(film, "SECONDS", 1.0)


@pytest.mark.slow
def test_a_circle_goes_round_and_is_not_run_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """With a player that does not learn: games on the table, of which one is recorded, and its diagnosis."""
    result = circle(tmp_path).run([], lambda done, count: None)
    assert {one.name for one in (tmp_path / "before" / "recordings").iterdir()} == {"game_5"}
    assert result["films"] == {"before": "before/film.gif"} and (tmp_path / "before" / "film.gif").stat().st_size > 1e4
    assert result["found"] == [] and result["arms"] == {} and result["before"].keys() == PLAYED
    assert result["simulator"].keys() == {"scored", "conceded"}
    assert (
        list(result["before"]["against"]) == [game[3] for game in result["before"]["games"]] == ["bank_shot", "goalie"]
    )
    shots = result["before"]["shots"]
    assert shots["faced"] > 0 and shots["made"] >= shots["scored"]
    assert sum(shots[kind] for kind in ("late", "bounce", "straight", "deflected")) == sum(
        conceded for _, conceded, *_ in result["before"]["games"]
    )
    html = (tmp_path / "gap.html").read_text(encoding="utf-8")
    assert "on a table with nothing: the control" in html and "--games 2 --seconds 12 --recorded 1" in html

    late = finding("camera_delay", "sensing", delay_s=0.002)
    content = json.loads((tmp_path / "diagnosis" / "diagnosis.json").read_text())
    (tmp_path / "diagnosis" / "diagnosis.json").write_text(json.dumps(content | {"findings": [late]}))
    with_arm = circle(tmp_path).run(["allowing"], lambda done, count: None)
    assert with_arm["before"] == result["before"] and with_arm["arms"]["allowing"]["shots"] != shots
    kept = json.loads((tmp_path / "allowing" / "games" / "game_5.json").read_text())
    assert kept["meeting"]["camera_delay"] == 0.002 and not (tmp_path / "allowing" / "training").exists()
    (tmp_path / "diagnosis" / "diagnosis.json").write_text(json.dumps(content))

    def again(*_: object) -> None:
        raise AssertionError("a game is played again")

    monkeypatch.setattr(meetings, "play_meeting", again)
    assert circle(tmp_path).run([], lambda done, count: None) == result


@pytest.mark.slow
def test_an_arm_is_fine_tuned_and_plays_games_of_the_same_seeds(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Wide networks of the champion, a round of a dozen tables."""
    preset = tmp_path / "tiny.toml"
    preset.write_text(TINY.replace("hidden = [16]", "hidden = [128, 128]"))
    monkeypatch.setattr(tuning, "PRESET", str(preset))
    made = circle(tmp_path / "out", player="policy:champion", seconds=4.0, minutes=1e-4)
    result = made.run(["unchanged"], lambda done, count: None)
    arm = tmp_path / "out" / "unchanged"
    settings = RunFolder(arm / "training").settings()
    assert settings["effects"] == AT_TABLE and settings["start"].endswith("champion.npz")
    assert settings["seed"] == 5 and settings["draws"] is None
    assert {one.name for one in (arm / "games").iterdir()} == {"game_5.json", "game_6.json", "recordings"}
    assert result["films"].keys() == {"before", "unchanged"} and (arm / "film.gif").exists()
    assert result["arms"]["unchanged"].keys() == {*PLAYED, "change"}
    before = (arm / "training" / "policy.npz").read_bytes()
    assert made.run(["unchanged"], lambda done, count: None) == result
    assert (arm / "training" / "policy.npz").read_bytes() == before


def test_a_folder_of_another_circle_is_refused(tmp_path: Path) -> None:
    keep_conditions(tmp_path, circle(tmp_path).folder.conditions)
    with pytest.raises(ValueError, match=r"has a circle with --table none; give the same, or name another --out"):
        circle(tmp_path, table="warp")


def test_players_that_several_tables_share_are_of_one_training(tmp_path: Path) -> None:
    def of(table: str, **others: Any) -> None:
        conditions = replace(CONDITIONS, table=table, **others)
        Circle(tmp_path / table, conditions, 1, lambda line: None, tmp_path / "of_any_table")
        keep_training(tmp_path / "of_any_table", conditions)

    of("walls")
    of("warp", games=4)
    with pytest.raises(ValueError, match=r"of_any_table has players with --minutes 1; give the same, or name another"):
        of("late", minutes=2.0)


@pytest.mark.parametrize("text", ["{", "[]", '{"table": "none"}'])
def test_a_folder_of_another_version_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "conditions.json").write_text(text)
    with pytest.raises(ValueError, match=r"conditions\.json is not of this version; name another --out"):
        circle(tmp_path)


@pytest.mark.parametrize(
    ("given", "said"),
    [
        (["--table", "wals"], "did you mean 'walls'"),
        (["--arms", "truht"], "did you mean 'truth'"),
        (["--recorded", "50"], "--recorded is 50"),
        (["--minutes", "0"], "--minutes is 0"),
        (["--steps", "0"], "--steps is 0"),
        (["--steps", "40000"], "--steps is 40,000; expected 1,310,720 or more: in fewer the critic alone learns"),
        (["--games", "5"], "--games is 5; expected 6 or more, two against each of interceptor, follower, bank_shot"),
        (["--stage", "tune"], "has no diagnosis yet; run the stage 'diagnose' first"),
        (["--steps", "9", "--minutes", "3"], "--minutes and --steps are both given"),
        (["nobody"], "nobody"),
    ],
)
def test_what_cannot_be_is_said_in_one_line(
    given: list[str], said: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert main(["gap", *given, "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert said in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_tables_and_arms_are_listed(capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gap", "--list"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert "  none         nothing: the control" in lines and any(line.startswith("  corrected") for line in lines)
