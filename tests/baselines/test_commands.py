"""`puckpilot match` and `puckpilot tournament`: their output, files and errors."""

from __future__ import annotations

import argparse
import csv
import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from baselines.commands import match, tournament
from baselines.matches.match import play
from baselines.ratings.intervals import paired_win_rate
from puckpilot_env.game import rules

DRILL = ["--variant", "defence-v0"]


def call(module, *words: str) -> int:
    parser = argparse.ArgumentParser()
    module.add_arguments(parser)
    return module.run(parser.parse_args(words))


@pytest.mark.slow
def test_match_json_agrees_with_the_games(capsys) -> None:
    words = ["follower", "still", "--games", "9", "--seed", "4", "--json", "--variant", "match-v0"]
    assert call(match, *words) == 0
    text = capsys.readouterr().out
    found = json.loads(text)
    keys = ["variant", "seed", "parameters", "effects", "drawn", "players", "games"]
    assert list(found) == [*keys, "wins", "draws", "goals", "fouls", "decisive_win_rate"]
    assert list(found["decisive_win_rate"]) == ["value", "low", "high"]
    result = play("match-v0", "follower", "still", 9, 4)
    assert (found["variant"], found["seed"], found["players"]) == ("puckpilot/match-v0", 4, ["follower", "still"])
    assert (found["games"], found["wins"], found["draws"]) == (9, list(result.wins), result.draws)
    assert found["goals"] == list(result.goals) and sum(found["wins"]) + found["draws"] == 9
    assert found["fouls"] == list(result.fouls)
    assert found["decisive_win_rate"]["value"] == pytest.approx(result.decisive_share)
    call(match, *words)
    assert capsys.readouterr().out == text
    call(match, *[word if word != "4" else "5" for word in words])
    assert capsys.readouterr().out.replace('"seed": 5', '"seed": 4') != text
    call(match, *words, "--set", "goal_width=0.1")
    assert json.loads(capsys.readouterr().out)["goals"] != found["goals"]


def test_a_drill_reports_each_player_s_own_episodes(capsys) -> None:
    words = ["random", "still", "--games", "9", "--seed", "4", *DRILL]
    assert call(match, *words, "--json") == 0
    found = json.loads(capsys.readouterr().out)
    assert list(found)[-2:] == ["games", "tested"]  # and no won or lost, which would add up two seats
    result = play("defence-v0", "random", "still", 9, 4)
    for tested, codes, name in zip(
        found["tested"], (result.endings[:5], result.endings[5:]), ("random", "still"), strict=True
    ):
        assert (tested["tested"], tested["episodes"], tested["job"]) == (name, len(codes), "clear")
        for ending in (rules.CLEAR, rules.LOST, rules.STEP_LIMIT):
            assert tested["endings"][rules.ENDING_NAMES[ending]]["count"] == (codes == ending).sum()
    assert call(match, *words) == 0
    rows = [line.split() for line in capsys.readouterr().out.splitlines()]
    assert [row[:3] for row in rows if row[1:2] in (["random"], ["still"])] == [
        ["random", "still", "5"], ["still", "random", "4"]
    ]  # fmt: skip


def test_match_text_agrees_with_the_games(capsys) -> None:
    assert call(match, "follower", "still", "--games", "6", "--threads", "2", "--variant", "match-v0") == 0
    words = capsys.readouterr().out
    result = play("match-v0", "follower", "still", 6, 0)
    rate = paired_win_rate(result.results)
    assert f"follower won {result.wins[0]} of {sum(result.wins)} decisive games" in words
    assert f"95 % interval {100 * rate.low:.1f} to {100 * rate.high:.1f} %" in words
    still = next(line.split() for line in words.splitlines() if line.split()[:1] == ["still"])
    assert still[1] == str(result.wins[1]) and still[-1] == f"{result.fouls[1] / 6:.1f}"


@pytest.mark.parametrize(
    "module, words", [(match, ["still", "random"]), (tournament, ["still", "random", "--out", "o"])]
)
def test_effects_and_draws_of_files_are_printed(module, words, tmp_path: Path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "effects.toml"
    file.write_text(
        'format = "puckpilot-effects/1"\n[effects.table_tilt]\ntilt_x = 0.02\n# not in the simulator: clock_drift\n'
    )
    drawn = tmp_path / "draws.toml"
    drawn.write_text('format = "puckpilot-draws/1"\n[draws.friction]\nlow = 0.1\nhigh = 0.2\n')
    both = ["--effects", str(file), "--draws", str(drawn)]
    call(module, *words, "--games", "2", *both, *DRILL)
    output = capsys.readouterr().out
    assert "effect on: table_tilt (tilt_x 0.02)" in output and "not switched on: clock_drift" in output
    assert "drawn for every episode: friction 0.1 to 0.2" in output
    call(module, *words, "--games", "2", *both, "--json", *DRILL)
    json.loads(capsys.readouterr().out)


def test_a_match_without_decisive_games_claims_nothing(capsys) -> None:
    assert call(match, "still", "still", "--games", "2", "--variant", "match-v0") == 0
    assert "No game of 2 was decisive" in capsys.readouterr().out


@pytest.mark.slow
@pytest.mark.parametrize("ending", ["gif", "mp4"])
def test_match_films_its_first_game(tmp_path: Path, capsys, ending: str) -> None:
    path = tmp_path / f"game.{ending}"
    call(match, "veteran", "random", "--games", "6", "--seed", "2", "--json", "--video", str(path), *DRILL)
    output = capsys.readouterr()
    assert json.loads(output.out)["games"] == 6
    steps = play("defence-v0", "veteran", "random", 6, 2).lengths[0]
    assert f"wrote {path}: {0.1 * steps:.1f} s of the first game" in output.err
    if ending == "gif":
        with Image.open(path) as film:
            lengths = []
            for frame in range(film.n_frames):  # pyright: ignore[reportAttributeAccessIssue] - a GIF has frames
                film.seek(frame)
                lengths.append(film.info["duration"])
        assert len(lengths) > 5 and 100 * steps <= sum(lengths) <= 100 * steps + 1000
    assert path.stat().st_size > 2000 and list(tmp_path.iterdir()) == [path]


@pytest.mark.slow
def test_tournament_writes_its_files(tmp_path: Path, capsys) -> None:
    words = ["still", "goalie", "interceptor", "--games", "10", "--seed", "3"]
    assert call(tournament, *words, "--out", str(tmp_path / "a" / "b"), "--json") == 0
    printed = json.loads(capsys.readouterr().out)
    folder = tmp_path / "a" / "b"
    assert sorted(path.name for path in folder.iterdir()) == ["payoff.csv", "payoff.png", "tournament.json"]
    assert json.loads((folder / "tournament.json").read_text()) == printed
    assert list(printed) == ["variant", "seed", "games", "players", "wins", "draws", "matches", "ratings"]
    wins, draws = np.array(printed["wins"]), np.array(printed["draws"])
    np.testing.assert_array_equal(wins + wins.T + draws, 10 * (1 - np.eye(3)))
    alone = play("match-v0", "goalie", "interceptor", 10, 3)
    assert (wins[1, 2], wins[2, 1], draws[1, 2]) == (*alone.wins, alone.draws)
    with (folder / "payoff.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["first"], row["second"]) for row in rows] == [
        ("still", "goalie"), ("still", "interceptor"), ("goalie", "interceptor")
    ]  # fmt: skip
    assert [int(row["wins"]) for row in rows] == [wins[0, 1], wins[0, 2], wins[1, 2]]
    assert [row["name"] for row in printed["ratings"]["players"]] == printed["players"]
    for row in printed["ratings"]["players"]:
        assert row["low"] < row["elo"] < row["high"] or (row["name"], row["elo"]) == ("interceptor", 0.0)
    with Image.open(folder / "payoff.png") as picture:
        assert picture.width > 500
    before = {path.name: path.read_bytes() for path in folder.iterdir()}
    call(tournament, *words, "--out", str(folder))
    assert {path.name: path.read_bytes() for path in folder.iterdir()} == before
    output = capsys.readouterr().out
    assert all(str(folder / name) in output for name in before)
    cells = next(line for line in output.splitlines() if line.split()[:1] == ["interceptor"])
    assert (
        cells.replace(" ", "")
        == "interceptor" + "".join(f"{wins[2, j]}/{draws[2, j]}/{wins[j, 2]}" for j in (0, 1)) + "-"
    )


def test_a_tournament_of_a_drill_has_tested_players_in_rows(tmp_path: Path, capsys) -> None:
    words = ["still", "goalie", "interceptor", "--games", "10", "--seed", "3", "--out", str(tmp_path), *DRILL]
    assert call(tournament, *words, "--json") == 0
    printed = json.loads(capsys.readouterr().out)
    assert list(printed) == ["variant", "seed", "games", "players", "tested"]  # no wins, no ratings
    pairs = [(one, other) for one in printed["players"] for other in printed["players"] if one != other]
    assert [(role["tested"], role["against"]) for role in printed["tested"]] == pairs
    alone = play("defence-v0", "goalie", "interceptor", 10, 3)
    shares = {}
    for role in printed["tested"]:
        shares[role["tested"], role["against"]] = role["endings"]["clear"]["value"]
    assert shares["goalie", "interceptor"] == (alone.endings[:5] == rules.CLEAR).mean()
    assert shares["interceptor", "goalie"] == (alone.endings[5:] == rules.CLEAR).mean()
    with (tmp_path / "payoff.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert [(row["tested"], row["against"], row["episodes"]) for row in rows] == [(*pair, "5") for pair in pairs]
    assert [float(row["clear share"]) for row in rows] == list(shares.values())
    with Image.open(tmp_path / "payoff.png") as picture:
        assert picture.width > 500
    call(tournament, *words)
    output = capsys.readouterr().out.splitlines()
    cells = next(line.split() for line in output if line.split()[:1] == ["interceptor"])
    each = [f"{100 * shares['interceptor', other]:.1f} %" for other in ("still", "goalie")]
    assert " ".join(cells) == " ".join(["interceptor", *each, "-"])


def test_all_players_take_part_and_no_count_is_truncated(tmp_path: Path, capsys, monkeypatch) -> None:
    from baselines import player_names

    monkeypatch.setenv("COLUMNS", "60")
    call(tournament, "--games", "2", "--out", str(tmp_path), *DRILL)
    output = capsys.readouterr().out
    assert "…" not in output
    assert any(line.split() == player_names() for line in output.splitlines())


@pytest.mark.parametrize(
    ("module", "words", "message"),
    [
        (match, ["goaly", "still"], "unknown player 'goaly'; did you mean 'goalie'"),
        (match, ["still", "stil"], "unknown player 'stil'; did you mean 'still'"),
        (match, ["still", "still", "--variant", "match-v1"], "unknown variant 'match-v1'; did you mean"),
        (match, ["still", "still", "--games", "0"], "games is 0; expected"),
        (match, ["still", "still", "--seed", "-1"], "seed is -1; expected"),
        (match, ["still", "still", "--threads", "0"], "threads is 0; expected"),
        (match, ["still", "still", "--set", "frction=0.1"], "unknown parameter 'frction'; did you mean 'friction'"),
        (match, ["still", "still", "--set", "friction"], "--set friction: expected NAME=NUMBER"),
        (match, ["still", "still", "--set", "friction=x"], "--set friction=x: expected NAME=NUMBER"),
        (match, ["still", "still", "--video", "game.avi"], r"ends in \.gif or \.mp4"),
        (tournament, ["still"], "players are still; expected two or more"),
        (tournament, ["still", "still"], "each named once"),
        (tournament, ["still", "goaly"], "unknown player 'goaly'"),
        (tournament, ["still", "goalie", "--games", "3"], "games is 3; expected an even number"),
        (tournament, ["still", "goalie", "--games", "0"], "games is 0; expected an even number"),
        (tournament, ["still", "goalie", "--variant", "x"], "unknown variant 'x'"),
    ],
)
def test_invalid_arguments_are_refused_in_one_line_without_files(module, words, message, tmp_path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(ValueError, match=message) as caught:
        call(module, *words)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_an_invalid_folder_is_refused_before_playing(tmp_path: Path, monkeypatch) -> None:
    (tmp_path / "file").write_text("")
    monkeypatch.setattr("baselines.matches.tournament.play", lambda *_, **__: pytest.fail("played"))
    with pytest.raises(ValueError, match="it is a file; give a folder"):
        call(tournament, "still", "goalie", "--out", str(tmp_path / "file"))
