"""`puckpilot link` and the port beneath it, end to end, with a board behind a pseudo-terminal."""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import time
from functools import partial

import pytest

import puckpilot
from sim2real.link.link_quality import faults_found
from sim2real.link.serial_port import PortError, SerialPort
from tests.places import ROOT
from tests.sim2real.link.fake_board import ARMED, FAULT, PING, FakeBoard, Terminal
from tests.sim2real.link.reference_wire import SCHEMA, frame


@pytest.fixture
def terminal(tmp_path):
    with Terminal(FakeBoard(), tmp_path / "board") as terminal:
        yield terminal


def refused(words: list[str], capsys: pytest.CaptureFixture[str]) -> str:
    assert puckpilot.main(["link", *words]) == 2
    printed = capsys.readouterr()
    assert printed.out == "" and printed.err.count("\n") == 1
    return printed.err.strip().removeprefix(f"puckpilot link {words[0]}: ")


def test_a_good_board(terminal, capsys):
    code = puckpilot.main(["link", "test", str(terminal.path), "--pings", "30", "--json"])
    found = json.loads(capsys.readouterr().out)
    assert found["bad"] == [] and code == 0
    assert found["port"] == str(terminal.path) and found["protocol"] == [1, 1]
    assert found["answered"] >= 30 and found["lost"] == 0 and found["pings"] == 30  # of one read count all
    assert 0.0 <= found["round_trip_ms"]["median"] <= found["round_trip_ms"]["p99"]
    assert 0.0 < found["clock_error_us"] < 5000 and abs(found["drift_ppm"]) <= found["drift_error_ppm"] + 20
    assert found["telemetry_hz"] == pytest.approx(500.0, rel=0.01) and found["missing"] == 0
    assert terminal.board.count(PING) >= 30 and {number for number, _ in terminal.board.heard} == {1, PING}


def test_its_words(terminal, capsys):
    assert puckpilot.main(["link", "test", str(terminal.path), "--pings", "10"]) == 0
    output = capsys.readouterr().out
    assert f"{terminal.path}: a board of protocol 1.1\n" in output and "pings: 10 answered, 0 lost\n" in output
    assert "telemetry: 500 a second, 0 missing\n" in output and output.endswith("all tests passed\n")


def test_a_noisy_line_is_bad_news(terminal, capsys):
    terminal.todo.append(lambda: setattr(terminal, "damage", 499))
    assert puckpilot.main(["link", "test", str(terminal.path), "--pings", "20", "--json"]) == 1
    found = json.loads(capsys.readouterr().out)
    assert sum(found["refused"].values()) > 5
    assert any("damaged frames from the board" in line for line in found["bad"])


def test_a_board_that_was_stopped_is_bad_news(terminal, capsys):
    terminal.board.state = FAULT
    assert puckpilot.main(["link", "test", str(terminal.path), "--pings", "5"]) == 1
    output = capsys.readouterr().out
    assert "bad: the board is in FAULT (" in output and "mend the cause, then reset it" in output


def test_pings_without_an_answer_are_bad_news(terminal, capsys):
    terminal.board.mute = {PING}
    assert puckpilot.main(["link", "test", str(terminal.path), "--pings", "5"]) == 1
    output = capsys.readouterr().out
    assert "pings: 0 answered" in output and "were never answered: check the cable" in output


def test_a_reset_during_the_test_is_bad_news(terminal, capsys):
    def reset() -> None:
        if terminal.board.count(PING) < 5:
            terminal.todo.append(reset)
            return
        terminal.board.boots += 1
        terminal.board.outbox.append(frame(12, "IBI", 0, 0, 0))

    terminal.todo.append(reset)
    assert puckpilot.main(["link", "test", str(terminal.path), "--pings", "20"]) == 1
    assert "bad: the board was reset 1 times" in capsys.readouterr().out


@pytest.mark.parametrize("board", [FakeBoard(version=(3, 1)), FakeBoard(schema=SCHEMA ^ 1)])
@pytest.mark.parametrize("action", ["test", "monitor"])
def test_another_protocol_cannot_be_tested(action, board, tmp_path, capsys):
    with Terminal(board, tmp_path / "board") as terminal:
        output = refused([action, str(terminal.path)], capsys)
    assert output.startswith(
        f"the board speaks protocol {board.version[0]}.{board.version[1]}, schema {board.schema:08x};"
    )


def test_a_port_that_is_not_there(tmp_path, capsys):
    path = tmp_path / "none"
    assert refused(["test", str(path)], capsys) == f"port {path} is not there; plug the board in, or name another port"


def test_what_is_no_serial_port(tmp_path, capsys):
    path = tmp_path / "file"
    path.write_text("")
    assert refused(["test", str(path)], capsys) == f"port {path} is not a serial port; give another"


def test_a_port_that_is_in_use(terminal, capsys):
    port = SerialPort(str(terminal.path))
    output = refused(["monitor", str(terminal.path)], capsys)
    assert output == f"port {terminal.path} is in use by another program; close that first"
    port.close()
    assert puckpilot.main(["link", "monitor", str(terminal.path), "--seconds", "0.1"]) == 0


def test_a_port_where_nobody_answers(tmp_path, capsys, monkeypatch):
    monkeypatch.setattr("sim2real.link.link_quality.GREETING", 0.3)
    board = FakeBoard()
    board.mute, board.telemetry_every = {1, PING}, 1 << 30
    with Terminal(board, tmp_path / "board") as terminal:
        output = refused(["test", str(terminal.path)], capsys)
    assert output == "no answer to hello in 0.3 s (no frame came); is this the board's port, at its baud rate?"


def test_a_port_that_vanishes_ends_a_test(terminal, capsys):
    def unplug() -> None:
        if terminal.board.count(PING) < 5:
            terminal.todo.append(unplug)
        else:
            terminal.unplug()

    terminal.todo.append(unplug)
    output = refused(["test", str(terminal.path)], capsys)
    assert output.startswith(f"the port vanished in the middle of the test (port {terminal.path} has vanished (")


def test_a_vanished_port_tells_so_whatever_is_done_with_it(terminal):
    port = SerialPort(str(terminal.path))
    terminal.todo.append(terminal.unplug)
    end = time.perf_counter() + 10.0
    with pytest.raises(PortError, match="has vanished"):
        while time.perf_counter() < end:
            port.read(100)
    with pytest.raises(PortError, match="has vanished"):
        port.write(b"x")
    port.close()
    port.close()
    with pytest.raises(PortError, match="has vanished"):
        port.read(100)


@pytest.mark.slow
def test_the_monitor_outlives_a_vanished_port(terminal, capsys):
    def at(pings: int, do) -> None:
        def later() -> None:
            if terminal.board.count(PING) < pings:
                terminal.todo.insert(0, later)
            else:
                do()

        terminal.todo.append(later)

    at(5, terminal.unplug)
    terminal.todo += [lambda: None] * 50  # rounds
    terminal.todo.append(lambda: setattr(terminal.board, "boots", 8))
    terminal.todo.append(terminal.plug)
    assert puckpilot.main(["link", "monitor", str(terminal.path), "--seconds", "2.2"]) == 0
    output = capsys.readouterr().out
    places = [
        output.index(words)
        for words in ("connected to a board", "waiting for it to come back", "the port is back", "the board was reset")
    ]
    assert places == sorted(places) and "UNHOMED  place unknown" in output[places[-1] :]


def test_the_monitor_as_json(terminal, capsys):
    terminal.board.state = ARMED
    assert puckpilot.main(["link", "monitor", str(terminal.path), "--seconds", "1.3", "--json"]) == 0
    rows = [json.loads(line) for line in capsys.readouterr().out.splitlines()]
    notes = [row["note"] for row in rows if "note" in row]
    assert notes == ["connected to a board of protocol 1.1", "the board was still armed; disarming it"]
    last = rows[-1]
    assert last["connected"] and last["state"] == "IDLE" and last["fault"] == "NONE"
    assert last["telemetry"]["pwm"] == [10, -20] and last["age_s"] < 1.0
    assert last["pings"]["answered"] > 5 and last["clock_error_us"] > 0
    assert len([row for row in rows if "state" in row]) == 2


def test_ctrl_c_ends_the_monitor(terminal):
    words = [sys.executable, "-m", "puckpilot", "link", "monitor", str(terminal.path)]
    heeds = partial(signal.signal, signal.SIGINT, signal.SIG_DFL)  # a shell's background jobs ignore it
    process = subprocess.Popen(
        words, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, preexec_fn=heeds
    )
    assert process.stdout is not None
    assert "connected to a board" in process.stdout.readline()
    assert any("UNHOMED" in line for line in process.stdout)
    process.send_signal(signal.SIGINT)
    _, errors = process.communicate(timeout=20)
    assert (process.returncode, errors) == (0, "")


@pytest.mark.parametrize(
    "words, message",
    [
        (["monitor", "--seconds", "0"], "--seconds is 0; expected a number above 0, at most 1e6"),
        (["monitor", "--seconds", "nan"], "--seconds is nan; expected a number above 0, at most 1e6"),
        (["test", "--pings", "1"], "--pings is 1; expected a whole number from 2 to 1000"),
        (["monitor", "--baud", "0"], "--baud is 0; expected a whole number above 0"),
    ],
)
def test_mistakes(words, message, capsys):
    assert refused([words[0], "/dev/none", *words[1:]], capsys) == message


def test_a_speed_beyond_any_port_s(terminal, capsys):
    output = refused(["test", str(terminal.path), "--baud", "999999999999"], capsys)
    assert "cannot be opened at 999999999999 baud" in output


def test_a_clock_that_no_crystal_drives_is_bad_news():
    """After 20 s of pings; a short test, which cannot know, says nothing of it."""
    clock = {"clock_error_us": 200.0, "drift_ppm": -250.0, "drift_error_ppm": 30.0}
    good = {
        "answered": 5, "lost": 0, "round_trip_ms": {"median": 1.0}, "refused": {}, "damaged_there": 0, "lost_there": 0,
        "telemetry_hz": 500.0, "missing": 0, "resets": 0, "echoes": 0, "clock_jumps": 0,
        "state": "IDLE", "fault": "NONE",
    }  # fmt: skip
    assert faults_found({**good, **clock}) == [
        "the board's clock goes wrong by -250 ppm: does it run from its crystal?"
    ]
    assert faults_found({**good, **clock, "drift_error_ppm": 250.0}) == []
