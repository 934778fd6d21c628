"""`puckpilot arena` where it cannot listen."""

from __future__ import annotations

import socket

import pytest

import puckpilot

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
