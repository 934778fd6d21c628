"""`puckpilot evaluate` as it is called: what it finds, and what it refuses in one line."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from baselines.match import play
from puckpilot import main


def test_it_says_what_the_games_say(capsys: pytest.CaptureFixture[str]) -> None:
    words = ["evaluate", "goalie", "--games", "6", "--seed", "3", "--json", "--hampered", "still"]
    assert main([*words, "--against", "still", "random", "--variants", "defence-v0"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert found["player"] == "goalie" and [row["opponent"] for row in found["meetings"]] == ["still", "random"]
    for row in found["meetings"]:
        result = play("defence-v0", "goalie", row["opponent"], 6, 3)
        assert (row["wins"], row["draws"], row["goals"]) == (list(result.wins), result.draws, list(result.goals))
        assert row["variant"] == "puckpilot/defence-v0" and row["games"] == 6
    measured = found["deployability"]
    assert 0.0 < measured["voltage_share"] < measured["voltage_most"] + 1e-6 < 1.0 + 2e-6
    assert measured["decision_us"] > 0.0
    assert [at["at"] for at in found["robustness"]["delay_s"]] == [0.0, 0.02, 0.04, 0.06]


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
        [],
    ],
    ids=" ".join,
)
def test_what_cannot_be_played_is_one_line(words: list[str], capsys: pytest.CaptureFixture[str]) -> None:
    try:
        code = main(["evaluate", *words])
    except SystemExit as stop:  # argparse's
        code = stop.code
    said = capsys.readouterr()
    assert code == 2 and said.err.startswith("puckpilot evaluate: ") and said.err.count("\n") == 1


def test_a_file_that_is_no_policy_is_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "a.npz").write_bytes(b"no policy")
    assert main(["evaluate", str(tmp_path / "a.npz")]) == 2
    assert "is no policy, or is cut short" in capsys.readouterr().err
