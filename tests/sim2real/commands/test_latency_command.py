"""`puckpilot latency`: of recordings, of a twin, as lines and as JSON, and what it refuses."""

from __future__ import annotations

import json

import pytest

import puckpilot
from sim2real.table.latency.part import Kind
from sim2real.table.latency.table_text import table_lines, toml_lines
from tests.places import PRACTICE, ROOT

DEMO = ROOT / "sim2real" / "demo_recording"
KIND = Kind("camera", "a to b", "pings")


def parts_of(capsys: pytest.CaptureFixture[str], *words: str) -> dict:
    assert puckpilot.main(["latency", *words, "--json"]) == 0
    return json.loads(capsys.readouterr().out)


@pytest.mark.slow
def test_of_the_demo_s_recording(capsys: pytest.CaptureFixture[str]) -> None:
    found = parts_of(capsys, str(DEMO))["recordings"][str(DEMO)]
    assert abs(found["camera"]["value"]) < 5e-4 and abs(found["camera_drift"]["value"]) < 20.0
    assert found["camera"]["low"] <= 0.0 <= found["camera"]["high"]
    assert found["command"]["value"] < 5e-4
    assert found["line"]["not_determined"] == "a recording holds no pings"


@pytest.mark.slow
@pytest.mark.skipif(not PRACTICE.is_dir(), reason="no shared recordings here")
def test_of_a_recording_with_a_known_delay(capsys: pytest.CaptureFixture[str]) -> None:
    where = PRACTICE / "rally_camera_delay"
    known = json.loads((PRACTICE / "key.json").read_text())["rally_camera_delay"]["values"]["delay_s"]
    camera = parts_of(capsys, str(where))["recordings"][str(where)]["camera"]
    assert camera["value"] == pytest.approx(known, abs=5e-4) and camera["low"] <= known <= camera["high"]


@pytest.mark.slow
def test_of_a_twin(capsys: pytest.CaptureFixture[str]) -> None:
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    assert puckpilot.main(["latency", "--seconds", "8", "--inject", "camera=0.017", "crystal=-60"]) == 0
    lines = capsys.readouterr().out.splitlines()
    head = lines[0].split()
    assert head[:2] == ["part", "value"] and "injected" in head
    name, value, unit, *_, injected = next(line for line in lines if line.startswith("camera ")).split()[:7]
    assert (name, unit, injected) == ("camera", "ms", "17.00") and float(value) == pytest.approx(17.0, abs=0.5)
    section = lines[lines.index("[latency]") :]
    assert f"{1e3 * float(section[2].split()[2]):.2f}" == value and section[2].startswith("camera = 0.01")
    assert section[1] == section[2].replace("camera", "delay")  # a twin's stamps are not corrected


def test_lines_say_what_is_known_and_why_not() -> None:
    parts = [KIND.found(0.017, 0.0005), Kind("line", "c to d", "pings").unknown("nobody listens")]
    assert table_lines(parts) == [
        "part    value     95 % interval   what    by",
        "camera  17.00 ms  16.50 to 17.50  a to b  pings",
        "line: not determined, because nobody listens",
    ]
    assert table_lines(parts, {"camera": 0.0171})[1] == "camera  17.00 ms  16.50 to 17.50  17.10     a to b  pings"
    assert toml_lines(parts) == ["[latency]", "camera = 0.017000  # s"]
    assert toml_lines(parts, 0.006) == ["[latency]", "delay = 0.023000  # s", "camera = 0.017000  # s"]
    assert toml_lines([KIND.found(-0.0071, 0.0005)], 0.006)[1] == "delay = 0.000000  # s"


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["--seconds", "3"], "--seconds is 3; expected 8 to 600"),
        (
            ["--inject", "camera=1"],
            "--inject camera=1: expected a number from 0 to 0.06 s, by which frames are stamped",
        ),
        (["--inject", "line=0.001", "--backend", "table"], "--inject is given with backend 'table'; only a twin takes"),
        (["--backend", "tabel"], "unknown backend 'tabel'; did you mean 'table'?"),
        (["--backend", "tabel", "--table", "x.toml"], "unknown backend 'tabel'; did you mean 'table'?"),
        (["--backend", "tabel", "--inject", "line=0.001"], "unknown backend 'tabel'; did you mean 'table'?"),
        ([str(DEMO), "--backend", "table"], "--backend is given with recordings; it takes a table: leave"),
        ([str(DEMO), "--table", "/nope"], "--table is given with recordings; it takes a table"),
        ([str(DEMO), "--seconds", "1"], "--seconds is given with recordings; it takes a table"),
        ([str(DEMO), "--seed", "0"], "--seed is given with recordings; it takes a table"),
        ([str(DEMO), "--inject", "line=0.001"], "--inject is given with recordings; it takes a twin"),
        (["/no/such/folder"], "/no/such/folder: is not a folder"),
    ],
)
def test_mistakes_get_one_line(words: list[str], message: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["latency", *words]) == 2
    assert message in capsys.readouterr().err
