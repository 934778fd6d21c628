"""`puckpilot play`: a player on the twin, reported in lines and as JSON."""

from __future__ import annotations

import json

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot
from sim2real.commands import play
from sim2real.table.faults import TableFaultError
from sim2real.table.twin.twin import Twin


@pytest.mark.slow
def test_a_game_is_reported_in_lines(capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["play", "interceptor", "--opponent", "still", "--seconds", "7", "--seed", "6"]) == 0
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
        (["goalie", "--backend", "tabel", "--table", "x.toml"], "unknown backend 'tabel'; did you mean 'table'?"),
        (["goalie", "--table", "x.toml"], "--table is given with --backend twin; it takes --camera and --opponent"),
        (["goalie", "--games", "0"], "--games is 0; expected a whole number from 1 to 1,000"),
        (["goalie", "--seconds", "0"], "--seconds is 0; expected more than 0"),
        (["agents/policies/champion.attack-v0.npz"], "attack-v0.npz was trained for puckpilot/attack-v0; here"),
        (["goalie", "--variant", "defence-v0"], "a table backend plays puckpilot/match-v0"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["play", *words]) == 2
    error = capsys.readouterr().err
    assert error.startswith("puckpilot play: ") and message in error and error.count("\n") == 1


@pytest.mark.slow
@pytest.mark.parametrize("answer", ["Ctrl-C", "no"])
def test_a_game_that_ends_at_a_fault_is_reported_all_the_same(
    answer: str, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    waits, wait = [], Twin.wait_for_frame

    def wait_and_unplug(twin: Twin, until: float) -> None:
        waits.append(until)
        twin.camera.unplugged = len(waits) > 60
        wait(twin, until)

    def may_clear(fault: TableFaultError) -> bool:
        if answer == "Ctrl-C":
            raise KeyboardInterrupt
        return False

    monkeypatch.setattr(Twin, "wait_for_frame", wait_and_unplug)
    monkeypatch.setattr(play, "_may_clear", lambda args: may_clear)
    assert puckpilot.main(["play", "still", "--opponent", "still", "--games", "2"]) == (0 if answer == "Ctrl-C" else 2)
    printed = capsys.readouterr()
    assert "stopped, camera silent: no frame for" in printed.out
    assert "still: 0 won, 0 lost of 1" in printed.out and "1 stops" in printed.out
    said = printed.err.splitlines()[-1]
    assert said == "ended by Ctrl-C" if answer == "Ctrl-C" else "no frame for" in said
