"""The commands of the benchmark: from a training to a report, and from an entry to whether it holds."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

import puckpilot
from agents.benchmark.protocol import read_protocol
from tests.agents.policy.some_policy import made
from tests.test_command import refused


@pytest.fixture
def short(request: pytest.FixtureRequest, monkeypatch: pytest.MonkeyPatch) -> None:
    """Evaluations of few games."""
    protocol = replace(read_protocol(), games=getattr(request, "param", 4))
    for module in ("agents.benchmark.protocol", "agents.benchmark.training"):
        monkeypatch.setattr(f"{module}.read_protocol", lambda: protocol)


def test_the_list_has_the_protocol_its_tasks_and_all_algorithms(capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["benchmark", "run", "--list"]) == 0
    printed = capsys.readouterr().out
    assert read_protocol().hash in printed and "corner_shot is kept out of training" in printed
    assert "  defence-randomized-v0  against still, goalie, interceptor\n" in printed and "sb3_sac" in printed


def test_the_list_says_what_an_algorithm_needs(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    def find(name: str) -> object:
        raise ModuleNotFoundError("No module named 'torch'", name="torch")

    monkeypatch.setattr("agents.benchmark.algorithms.find_algorithm", find)
    assert puckpilot.main(["benchmark", "run", "--list"]) == 0
    assert "  sb3_ppo                needs torch: pip install 'puckpilot[train,benchmark]'" in capsys.readouterr().out


@pytest.mark.usefixtures("short")
def test_trainings_are_kept_and_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["benchmark", "run", "random", "interceptor", "--tasks", "attack-v0", "--out", str(tmp_path), "--json"]
    assert puckpilot.main(words) == 0
    first = json.loads(capsys.readouterr().out)
    assert [one["algorithm"] for one in first["outcomes"]] == ["random", "interceptor"]
    assert puckpilot.main(words) == 0 and json.loads(capsys.readouterr().out) == first
    assert puckpilot.main(["benchmark", "report", str(tmp_path)]) == 0
    printed = capsys.readouterr().out
    assert "attack-v0" in printed and str(tmp_path / "report.md") in printed
    assert "## attack-v0" in (tmp_path / "report.md").read_text(encoding="utf-8")


@pytest.mark.slow
@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("short", [100], indirect=True)
def test_an_entry_is_made_and_holds_until_it_claims_more(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    player = str(made("attack-v0").save(tmp_path / "mine.npz"))
    words = ["benchmark", "enter", player, "--name", "ours", "--trained", "not at all", "--tasks", "attack-v0"]
    assert puckpilot.main([*words, "--out", str(tmp_path / "board")]) == 0
    entry = tmp_path / "board" / "ours.toml"
    assert str(entry) in capsys.readouterr().out
    check = ["benchmark", "verify", str(entry.with_suffix("")), "--seed", "3", "--json"]
    assert puckpilot.main(check) == 0 and json.loads(capsys.readouterr().out)["holds"] is True
    text = entry.read_text(encoding="utf-8")
    lines = ["won = 100" if line.startswith("won = ") else line for line in text.splitlines()]
    lines = ["lost = 0" if line.startswith("lost = ") else line for line in lines]
    entry.write_text("\n".join(lines), encoding="utf-8")
    assert puckpilot.main(check) == 1
    found = json.loads(capsys.readouterr().out)
    assert found["holds"] is False and found["seed"] == 3
    assert next(one["what"] for one in found["findings"] if not one["holds"]) == "attack-v0 against still"


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["run"], "no algorithm is given; expected some of interceptor, league_ppo, "),
        (["run", "ppo2"], "unknown algorithm 'ppo2'"),
        (["run", "random", "--tasks", "match"], "'match' is no task of the protocol; expected some of match-v0, "),
        (["run", "random", "--seeds", "0"], "--seeds is 0; expected 1 or more"),
        (["run", "random", "--steps", "-1"], "--steps is -1; expected 1 or more"),
        (["report", "nowhere"], "nowhere has no outcomes; expected the --out of puckpilot benchmark run"),
        (["enter", "interceptor", "--name", "x", "--trained", ""], "no policy 'interceptor'; expected 'champion', "),
        (["enter", "champion", "--name", "champion", "--trained", ""], "leaderboard has an entry 'champion'; choose"),
        (["enter", "champion", "--name", "x y", "--trained", ""], "--name is 'x y'; expected letters, digits, - and _"),
        (["verify", "nowhere"], "cannot read an entry from 'nowhere.toml': No such file or directory; expected"),
        (["verify", "nowhere", "--games", "100"], "--games is 100; expected an even number from 200 to 100000"),
        (["verify", "nowhere", "--seed", "-1"], "seed is -1"),
        (["verify", "nowhere", "--memory", "0"], "--memory is 0; expected more than 0, up to 1000"),
    ],
)
def test_a_wrong_input_is_one_line(words: list[str], said: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert said in refused(["benchmark", *words], capsys)
