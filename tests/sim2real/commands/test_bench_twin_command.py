"""`puckpilot bench twin`: its figures from a short run, and its mistakes."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot


@pytest.mark.slow
def test_speed_and_both_games_are_reported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["bench", "twin", "interceptor", "--opponent", "still", "--games", "1", "--seconds", "1"]
    assert puckpilot.main([*words, "--folder", str(tmp_path), "--json"]) == 0
    result = json.loads(capsys.readouterr().out)
    assert (tmp_path / "game_0.json").exists()
    assert result["twin"]["minutes"] == pytest.approx(1.0 / 60.0)
    assert result["simulator"]["wins"] == [1, 0]
    speed = result["speed"]
    assert speed["virtual_s"] > 1.0 and 0.1 < speed["times_real_time"] < 100.0
    assert puckpilot.main([*words, "--folder", str(tmp_path)]) == 0  # from the file
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("twin       interceptor ") and lines[1].startswith("simulator  interceptor 1:0 still")
    assert f"{speed['times_real_time']:.2f} times real time of one core" in lines[-1]


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["goaly"], "unknown player 'goaly'; did you mean 'goalie'?"),
        (["goalie", "--games", "0"], "--games is 0; expected a whole number from 1 to 10,000"),
        (["goalie", "--seconds", "0"], "--seconds is 0; expected more than 0"),
        (["goalie", "--camera", "picture"], "unknown camera 'picture'; did you mean 'pictures'?"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["bench", "twin", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("puckpilot bench twin: ") and message in error and error.count("\n") == 1
