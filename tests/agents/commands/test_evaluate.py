"""`puckpilot evaluate`: its results, and what it refuses in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from baselines.matches.match import play
from puckpilot import main
from puckpilot_env.game.rules import ENDING_NAMES

PLAYERS = ("follower", "still", "random")


@pytest.mark.slow
def test_json_agrees_with_the_games(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "goalie", "--games", "6", "--seed", "3", "--json", "--hampered", "still"]
    assert main([*words, "--against", "still", "random", "--variants", "defence-v0"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["player"] == "goalie" and [row["opponent"] for row in found["meetings"]] == ["still", "random"]
    for row in found["meetings"]:
        result = play("defence-v0", "goalie", row["opponent"], 6, 3)
        assert row["variant"] == "puckpilot/defence-v0" and row["games"] == 6
        assert not {"wins", "draws", "goals", "decisive_win_rate"} & set(row)  # those would add up two seats
        endings = [ENDING_NAMES[ending] for ending in result.endings[:3]]  # as player_0
        role = row["role"]
        assert (role["tested"], role["job"], role["episodes"]) == ("goalie", "clear", 3)
        for name in ("clear", "possession lost", "step limit"):
            share = role["endings"][name]
            assert share["count"] == endings.count(name) and share["value"] == endings.count(name) / 3
            assert share["low"] <= share["value"] <= share["high"]
    assert found["ratings"] == []  # drills rate nobody
    measured = found["deployability"]
    assert 0.0 < measured["voltage_share"] < measured["voltage_most"] + 1e-6 < 1.0 + 2e-6
    assert measured["decision_us"] > 0.0
    assert [at["at"] for at in found["robustness"]["delay_s"]] == [0.0, 0.02, 0.04, 0.06]


@pytest.mark.slow
def test_tables_show_jobs_in_drills_and_ratings_in_matches(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "follower", "--games", "4", "--hampered", "still", "--against", "still", "random", "random"]
    assert main([*words, "--variants", "attack-v0", "match-v0", "drills"]) == 0
    printed = capsys.readouterr().out.splitlines()
    rows = [line.split() for line in printed]
    titles = [line for line in printed if "how the episodes ended in which follower was tested" in line]
    assert [title.split(",")[0] for title in titles] == ["attack-v0", "defence-v0"]  # each once, in the given order
    drills = [row for row in rows if row[:1] == ["follower"] and row[2:3] == ["2"]]
    played = [(drill, other) for drill in ("attack-v0", "defence-v0") for other in ("still", "random")]
    for row, (drill, other) in zip(drills, played, strict=True):
        result = play(drill, "follower", other, 4, 0)
        job = "shot on goal" if drill == "attack-v0" else "clear"
        done = sum(ENDING_NAMES[number] == job for number in result.endings[:2])
        assert row[1] == other and row[3:5] == [f"{50 * done:.1f}", "%"]
    game = play("match-v0", "follower", "still", 4, 0)
    match = next(row for row in rows if row[:2] == ["match-v0", "still"])
    assert match[6] == "{:.1f}:{:.1f}".format(*(fouls / 4 for fouls in game.fouls))
    assert "match-v0, rated by 4 games of follower with each and 4 of every two of the others:" in printed
    ranked = [row[0] for row in rows[[row[:1] for row in rows].index(["player"]) :] if row and row[0] in PLAYERS]
    assert ranked[0] == "follower" and sorted(ranked) == sorted(PLAYERS)


@pytest.mark.slow
def test_several_policies_stand_side_by_side(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "follower", "goalie", "--games", "4", "--against", "still", "--variants", "match-v0", "drills"]
    assert main([*words, "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["players"] == ["follower", "goalie"]
    assert [row["variant"] for row in found["over_seeds"]] == [
        f"puckpilot/{one}-v0" for one in ("match", "defence", "attack")
    ] + ["all"]
    alone = play("match-v0", "follower", "still", 4, 0)
    assert found["over_seeds"][0]["shares"][0] == alone.wins[0] / max(sum(alone.wins), 1)
    assert main(words) == 0
    printed = capsys.readouterr().out
    assert "1: follower\n2: goalie\n" in printed and "of fewer than four the IQM is the mean" in " ".join(
        printed.split()
    )


@pytest.mark.parametrize(
    "words",
    [
        ["nobody"],
        ["no/such/file.npz"],
        ["policy:nobody"],
        ["goalie", "--games", "3"],
        ["goalie", "--games", "0"],
        ["goalie", "--games", "-2"],
        ["goalie", "--games", "few"],
        ["goalie", "--against", "nobody"],
        ["goalie", "--hampered", "nobody"],
        ["goalie", "--variants", "chess-v0"],
        ["goalie", "--seed", "-1"],
        ["goalie", "goalie"],
        [],
    ],
    ids=" ".join,
)
def test_invalid_evaluations_are_refused_in_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["evaluate", *words])
    except SystemExit as stop:  # argparse's
        code = stop.code
    said = capsys.readouterr()
    assert code == 2 and said.err.startswith("puckpilot evaluate: ") and said.err.count("\n") == 1


def test_a_file_that_is_no_policy_is_refused_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.npz").write_bytes(b"no policy")
    assert main(["evaluate", str(tmp_path / "a.npz")]) == 2
    assert "is not a policy, or is truncated" in capsys.readouterr().err
