"""A stage alone: what it says that it needs, and the result of what the others left."""

from __future__ import annotations

import argparse
import json
from dataclasses import asdict, replace
from pathlib import Path

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from puckpilot import main
from puckpilot_env.options.at_table import AT_TABLE
from sim2real.commands import gap
from sim2real.gap import in_simulator
from sim2real.gap import result as result_module
from sim2real.gap.circle import Circle
from sim2real.gap.circle_folder import Conditions
from sim2real.gap.gap_table import find_gap_table
from sim2real.gap.in_simulator import simulate, simulated_rates
from sim2real.gap.report import page as page_module
from sim2real.gap.stages import STAGES, simulated_tables
from sim2real.table.meetings import Meeting, PlayedMeeting
from tests.sim2real.gap.test_against_truth import SILENT_DRAWS, SILENT_EFFECTS

CONDITIONS = Conditions("interceptor", ("goalie", "still"), "twin", "late", 4, 20.0, 2, 1.0, None, 5)
DIAGNOSIS = {
    "verdict": "parameters_only", "findings": [], "baseline": {"parameters": {"friction": {"value": 0.11}}},
    "regimes": [{"regime": "glide", "verdict": "parameters_only"}, {"regime": "wall", "reason": "too few hits"}],
}  # fmt: skip


def run(folder: Path, stage: str, arms: list[str]) -> None:
    Circle(folder, CONDITIONS, 1, lambda line: None).run_stage(stage, arms, lambda done, count: None)


@pytest.fixture
def diagnosed(tmp_path: Path) -> Path:
    """A circle's folder with a silent diagnosis."""
    texts = {"diagnosis.json": json.dumps(DIAGNOSIS), "effects.toml": SILENT_EFFECTS, "draws.toml": SILENT_DRAWS}
    (tmp_path / "diagnosis").mkdir()
    for name, text in texts.items():
        (tmp_path / "diagnosis" / name).write_text(text)
    return tmp_path


@pytest.mark.parametrize(
    ("stage", "said"),
    [
        ("diagnose", "before has no recordings of 2 games that were over yet; run the stage 'play' first"),
        ("tune", "diagnosis has no diagnosis yet; run the stage 'diagnose' first"),
        ("replay", "diagnosis has no diagnosis yet; run the stage 'diagnose' first"),
        ("report", "simulator has no games yet; run the stage 'play' first"),
    ],
)
def test_a_stage_alone_says_which_has_to_be_run_first(stage: str, said: str, tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=said):
        run(tmp_path, stage, ["corrected"])


def test_a_recording_of_a_game_that_was_broken_off_is_not_diagnosed(tmp_path: Path) -> None:
    for name in ("game_5", "game_6"):
        (tmp_path / "before" / "recordings" / name).mkdir(parents=True)
    with pytest.raises(ValueError, match="before has no recordings of 2 games that were over yet"):
        run(tmp_path, "diagnose", ["corrected"])


def test_the_simulator_has_the_truth_but_for_what_is_late() -> None:
    warp, late, none = (simulated_tables(find_gap_table("twin", name)) for name in ("warp", "late", "none"))
    concealed = {"tilt_x": -0.2, "tilt_y": 0.1, "warp_xx": 0.5, "warp_yy": -0.25}
    assert warp == {"unchanged": dict(AT_TABLE), "truth": {**AT_TABLE, **concealed}}
    assert late == {"unchanged": dict(AT_TABLE)} and none == {"unchanged": dict(AT_TABLE), "truth": dict(AT_TABLE)}


def test_a_score_in_the_simulator_is_of_the_goals_by_hand_and_made_anew_for_another_player(tmp_path: Path) -> None:
    path, policy = tmp_path / "one.json", tmp_path / "policy.npz"
    for player, games in (("goalie", 2), ("still", 1)):
        policy.write_bytes(player.encode())  # who it is, is asked of the file; who plays is another question
        with pytest.MonkeyPatch.context() as patch:
            patch.setattr(in_simulator, "_goals", lambda *_, of=games: {"goals": [3 * of, of], "minutes": 2.0})
            for _ in range(2):
                simulate(path, "match-v0", f"policy:{policy}", ["goalie"], games, 1, {"unchanged": {}})
        assert simulated_rates(path)["unchanged"] == {"scored": 1.5 * games, "conceded": 0.5 * games}


def test_an_arm_is_not_played_before_it_has_learnt(diagnosed: Path) -> None:
    with pytest.raises(ValueError, match="corrected has no trained player yet; run the stage 'tune' first"):
        run(diagnosed, "replay", ["corrected"])


def test_the_report_alone_is_of_what_is_there(diagnosed: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Nothing was named, though the table is late: the page says so, and shows the films that there are."""

    def kept(meetings: list[Meeting], folder: Path) -> list[PlayedMeeting]:
        assert folder in (diagnosed / "before", diagnosed / "allowing" / "games")
        return [PlayedMeeting(1, (k, 1), 20.0, 22.0, 2.0, 2.0, opponent=one.opponent) for k, one in enumerate(meetings)]

    monkeypatch.setattr(result_module, "kept_games", kept)
    for name in ("simulator", "before", "allowing"):
        (diagnosed / name).mkdir()
    against = {"goalie": {"goals": [10, 2], "minutes": 2.0}, "still": {"goals": [9, 0], "minutes": 1.0}}
    for name in ("before", "allowing"):
        tables = {"unchanged": against, "truth": {"goalie": {"goals": [4, 4], "minutes": 2.0}}}
        (diagnosed / "simulator" / f"{name}.json").write_text(json.dumps({"player": "interceptor", "tables": tables}))
    (diagnosed / "before" / "film.gif").touch()
    run(diagnosed, "report", ["allowing"])
    result = json.loads((diagnosed / "gap.json").read_text())
    assert result["simulator"] == {"scored": 7.0, "conceded": 0.5}
    assert result["in_simulator"]["allowing"]["truth"] == {"scored": 2.0, "conceded": 2.0}
    assert result["before"]["against"]["still"]["scored"]["value"] == 6.0  # in the second and the fourth game, of 20 s
    assert result["films"] == {"before": "before/film.gif"}
    assert [one["outcome"] for one in result["against_truth"]] == ["missed", "missed"]
    assert result["learnt"]["draws"] == {"friction": [0.1, 0.12]}
    html = (diagnosed / "gap.html").read_text(encoding="utf-8")
    assert '<img src="before/film.gif"' in html and "allowing/film.gif" not in html
    assert (
        "Nothing: the simulator&#39;s laws explain that play" in html
        and "Undetermined: wall: too few hits." in html
        and "friction 0.1 to 0.12" in html
    )
    monkeypatch.setattr(result_module, "kept_games", lambda meetings, folder: kept(meetings[1:], folder))
    with pytest.raises(ValueError, match="before has no 4 games yet; run the stage 'play' first"):
        run(diagnosed, "report", ["allowing"])


def test_the_command_runs_a_stage_alone(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert main(["gap", "--stage", "diagnos", "--out", str(tmp_path / "out")]) == 2
    assert "did you mean 'diagnose'" in capsys.readouterr().err and not (tmp_path / "out").exists()
    assert main(["gap", "interceptor", "--stage", "tune", "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert "run the stage 'diagnose' first" in error and error.count("\n") == 1
    assert main(["gap", "--list"]) == 0
    assert capsys.readouterr().out.splitlines()[-len(STAGES) - 1] == "stages"


@pytest.mark.parametrize("option", ["--arms", "--table", "--opponent"])
def test_what_is_named_twice_is_refused(option: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    name = {"--arms": "truth", "--table": "walls", "--opponent": "goalie"}[option]
    twice = [option, name, name] if option == "--arms" else [option, name, option, name]
    assert main(["gap", *twice, "--out", str(tmp_path / "out")]) == 2
    assert f"{option} names {name} more than once; name it once" in capsys.readouterr().err


def test_the_page_s_command_makes_the_same_circle() -> None:
    parser = argparse.ArgumentParser()
    gap.add_arguments(parser)
    many = replace(CONDITIONS, minutes=None, steps=9830400, seconds=59.123456789)
    words = page_module._command(asdict(many), ["corrected", "truth"]).split()
    given = parser.parse_args(words[2:])
    assert (given.steps, given.seconds, given.arms, given.games) == (9830400, 59.123456789, ["corrected", "truth"], 4)
    assert (given.table, given.opponent, given.seed) == (["late"], ["goalie", "still"], 5)
