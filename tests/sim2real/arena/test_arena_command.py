"""`puckpilot arena` where it cannot do what is asked."""

from __future__ import annotations

import socket
from pathlib import Path

import pytest

import puckpilot
from tests.places import ROOT

pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")


def test_a_port_that_is_taken_and_a_host_that_is_none_are_refused_in_one_line(capsys: pytest.CaptureFixture) -> None:
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        assert puckpilot.main(["arena", "still", "--port", str(port)]) == 2
        said = capsys.readouterr().err.strip().splitlines()[-1]
        assert said == (
            f"puckpilot arena: cannot listen on 127.0.0.1:{port}: Address already in use; give another --host or --port"
        )
    assert puckpilot.main(["arena", "still", "--host", "no.such.host.invalid"]) == 2
    said = capsys.readouterr().err.strip().splitlines()[-1]
    assert said.startswith("puckpilot arena: cannot listen on no.such.host.invalid:8420: ") and "Unknown" not in said


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (
            ["--diagnosis", "none"],
            "none: no diagnosis can be read there (No such file or directory); expected the folder",
        ),
        (["--concealed"], "--concealed is given with a recording; expected a player to play against"),
        (["--quick"], "--quick is given with a recording; expected a player to play against"),
    ],
)
def test_what_does_not_go_with_a_recording_is_refused_in_one_line(
    options: list[str], words: str, capsys: pytest.CaptureFixture, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert puckpilot.main(["arena", str(ROOT / "sim2real" / "demo_recording"), *options]) == 2
    assert capsys.readouterr().err.startswith(f"puckpilot arena: {words}")


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["still", "goalie", "--quick"], "--quick is given where you do not play; expected one player to play against"),
        (
            ["still", "goalie", "--seat", "1"],
            "--seat is given where you do not play; expected one player to play against",
        ),
        (
            ["still", "goalie", "random", "--concealed"],
            "--concealed is given with 3 players; expected one to play against",
        ),
        (
            ["out/a_recordin"],
            "there is no folder 'out/a_recordin'; expected the folder of a recording, or a player's name",
        ),
        (["policy:out/a_run"], "no policy 'out/a_run'"),
    ],
)
def test_what_does_not_go_with_players_is_refused_in_one_line(
    words: list[str], said: str, capsys: pytest.CaptureFixture, tmp_path: Path
) -> None:
    assert puckpilot.main(["arena", *words, "--out", str(tmp_path)]) == 2
    assert f"puckpilot arena: {said}" in capsys.readouterr().err
