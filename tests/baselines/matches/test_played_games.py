"""Matches that were played one by one: what ratings take of them, and what is refused."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

import puckpilot
from baselines.matches.played_games import add_game, read_pairs
from baselines.matches.tournament import play_tournament


def written(file: Path, *games: tuple[str, str, int, int]) -> Path:
    for number, (first, second, goals, conceded) in enumerate(games):
        add_game(
            file,
            (first, second),
            (goals, conceded),
            recording=f"game {number}",
            ending="time",
            seed=number,
            ended="now",
        )
    return file


def test_each_two_matches_of_the_same_players_are_a_pair_from_either_seat(tmp_path: Path) -> None:
    file = written(
        tmp_path / "games.jsonl",
        ("human:ann", "goalie", 3, 1), ("human:bob", "goalie", 0, 0), ("goalie", "human:ann", 2, 2),
        ("goalie", "human:ann", 4, 0), ("human:ann", "goalie", 1, 0), ("human:ann", "goalie", 7, 0),
    )  # fmt: skip
    assert read_pairs(file) == {("human:ann", "goalie"): [[1, 0], [-1, 1]]}


@pytest.mark.parametrize("line", ["", "[]", "7", '{"players": ["a", "b"]}', '{"players": ["a"], "score": [1, 2]}',
                                  '{"players": ["a", "b"], "score": ["x", 2]}'])  # fmt: skip
def test_a_file_of_something_else_is_refused_in_one_line(line: str, tmp_path: Path) -> None:
    file = written(tmp_path / "games.jsonl", ("human:ann", "goalie", 3, 1))
    file.write_text(file.read_text() + line + "\n")
    with pytest.raises(ValueError, match=r"games.jsonl, line 2: not a match") as error:
        read_pairs(file)
    assert "\n" not in str(error.value)


@pytest.mark.slow
def test_a_person_is_rated_with_the_players(tmp_path: Path, capsys: pytest.CaptureFixture) -> None:
    """Ann beats the goalie as often as she loses to it, so that she is rated as it is, less surely."""
    games = [("human:ann", "goalie", *score) for score in ((3, 1), (1, 3)) * 4]
    file = written(tmp_path / "games.jsonl", *games)
    words = ["tournament", "interceptor", "goalie", "--games", "20", "--out", str(tmp_path / "out"), "--json"]
    assert puckpilot.main([*words, "--played", str(file)]) == 0
    rows = {row["name"]: row for row in json.loads(capsys.readouterr().out)["ratings"]["players"]}
    assert set(rows) == {"interceptor", "goalie", "human:ann"} and rows["interceptor"]["elo"] == 0.0
    ann, goalie = rows["human:ann"], rows["goalie"]
    assert abs(ann["elo"] - goalie["elo"]) < 40.0
    assert ann["high"] - ann["low"] > 60.0 and ann["low"] < ann["elo"] < ann["high"]


def test_persons_who_met_none_of_the_players_cannot_be_rated(tmp_path: Path) -> None:
    played = {("human:ann", "veteran"): [[1, 1]]}
    with pytest.raises(ValueError, match=r"human:ann and veteran played, of whom neither takes part"):
        play_tournament("match-v0", ["still", "goalie"], 2, 0, played=played)


@pytest.mark.slow
def test_matches_of_players_who_meet_anew_are_counted_as_well(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    """In whichever order the file names them: its goalie won both."""
    file = written(tmp_path / "games.jsonl", *[("goalie", "interceptor", 3, 1)] * 2)
    words = ["tournament", "interceptor", "goalie", "--games", "20", "--out", str(tmp_path / "out")]
    assert puckpilot.main([*words, "--json"]) == 0
    alone = json.loads(capsys.readouterr().out)
    assert puckpilot.main([*words, "--json", "--played", str(file)]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["players"] == alone["players"] == ["interceptor", "goalie"]
    assert np.subtract(found["wins"], alone["wins"]).tolist() == [[0, 0], [2, 0]] and found["draws"] == alone["draws"]
    assert puckpilot.main([*words, "--played", str(file)]) == 0
    assert f"20 games of every two players, and those of {file}, seed 0" in capsys.readouterr().out
