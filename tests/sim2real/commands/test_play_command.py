"""`puckpilot play`: a player on the twin, reported in lines and as JSON."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot


@pytest.mark.slow
def test_a_game_is_reported_in_lines(capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["play", "interceptor", "--opponent", "still", "--seconds", "7", "--seed", "3"]) == 0
    lines = capsys.readouterr().out.splitlines()
    assert any("goal of the robot" in line for line in lines)
    assert any(line.startswith("game 1: interceptor ") and line.endswith(" still") for line in lines)
    assert any("plans sent; mallet off its path by at most" in line for line in lines)


def test_a_game_is_reported_as_json(capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["play", "still", "--opponent", "still", "--seconds", "0.5", "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert result["games"] == 1 and result["seconds"] == pytest.approx(0.5)
    assert result["plans"] > 5 and result["mallet_off_path_m"] < 0.003


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["goaly"], "unknown player 'goaly'; did you mean 'goalie'?"),
        (["goalie", "--backend", "tabel"], "unknown backend 'tabel'; did you mean 'table'?"),
        (["goalie", "--games", "0"], "--games is 0; expected a whole number from 1 to 1,000"),
        (["goalie", "--seconds", "0"], "--seconds is 0; expected more than 0"),
        (["goalie", "--variant", "defence-v0"], "a table backend plays puckpilot/match-v0"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["play", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("puckpilot play: ") and message in error and error.count("\n") == 1
