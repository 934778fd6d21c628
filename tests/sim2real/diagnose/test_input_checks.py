"""Unusable recordings: an error in one line, or `undetermined`, and never a finding."""

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

from puckpilot import main
from sim2real.diagnose.input_checks import UndeterminedError, check_usable
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

CAMERA = Camera(noise=0.0006, rate=150.0)
SECONDS, LONGER = 30.0, 45.0


def _make(folder: Path, law: Law, scenario: str = "launches", seed: int = 5, seconds: float = SECONDS) -> Path:
    make_recording(folder, law, scenario, seed, seconds, camera=CAMERA, dt=2e-5)
    return folder


@pytest.fixture(scope="module")
def tilted(tmp_path_factory):
    return _make(tmp_path_factory.mktemp("tables") / "tilted", Law(tilt_x=0.02), seconds=LONGER)


@pytest.fixture(scope="module")
def rally(tmp_path_factory):
    return _make(tmp_path_factory.mktemp("tables") / "rally", Law(), "rally")


def _change(source: Path, folder: Path, file: str, change) -> Path:
    """Return a copy of a recording with the lines (the header first) of one file replaced by `change`."""
    shutil.copytree(source, folder)
    lines = (folder / file).read_text().splitlines()
    (folder / file).write_text("\n".join(change(lines)) + "\n")
    return folder


def _restamp(new_time):
    def change(lines):
        cells = (line.split(",", 1) for line in lines[1:])
        return [lines[0], *(f"{new_time(float(t)):.6f},{rest}" for t, rest in cells)]

    return change


def _puck_at(place):
    def change(lines):
        cells = [line.split(",") for line in lines[1:]]
        return [lines[0], *(",".join([row[0], *place(), *row[3:]]) for row in cells)]

    return change


NOISE = np.random.default_rng(1)


def _noisy():
    return [f"{value:.5f}" for value in NOISE.normal((0.7, 0.4), 0.0006)]


def _sized(factors):
    def change(lines):
        meta = json.loads("\n".join(lines))
        meta["table"] = {key: round(value * factors.get(key, 1.0), 4) for key, value in meta["table"].items()}
        return json.dumps(meta, indent=1).splitlines()

    return change


def _diagnosed(out: Path, capsys, *words: Path | str) -> dict:
    assert main(["diagnose", *map(str, words), "--out", str(out), "--json"]) == 0
    return json.loads(capsys.readouterr().out)


def _undetermined(expected: dict, *message: str) -> None:
    assert (expected["verdict"], expected["findings"]) == ("undetermined", [])
    assert all(word in expected["reason"] for word in message), expected["reason"]
    assert expected["next_recording"]


@pytest.mark.parametrize(
    "file, change, message",
    [
        ("frames.csv", lambda lines: lines[: 3 * 150], ["too little data"]),
        ("frames.csv", lambda lines: lines[:1], ["too little data"]),
        ("frames.csv", _puck_at(_noisy), ["never moves"]),
        ("frames.csv", _puck_at(lambda: ["0.7", "0.4"]), ["never moves"]),
        ("frames.csv", _restamp(lambda t: t + 5.0 * (t // 10.0)), ["frames.csv", "jumps by 5000 ms"]),
        ("frames.csv", _restamp(lambda t: t + 0.05 * (t // 3.0)), ["frames.csv", "jumps by 50 ms"]),
        ("meta.json", _sized({"length_m": 1.03}), ["stated length of 2.060 m"]),
        ("meta.json", _sized({"width_m": 0.97}), ["stated width of 0.970 m"]),
        ("meta.json", _sized({"length_m": 1.03, "width_m": 1.03, "goal_width_m": 1.03}), ["stated length of 2.060 m"]),
    ],
    ids=["3 s", "header", "still", "frozen", "leaps", "small leaps", "too long", "too narrow", "too large"],
)
def test_unusable_frames_are_undetermined(tilted, tmp_path, capsys, file, change, message):
    broken = _change(tilted, tmp_path / "broken", file, change)
    _undetermined(_diagnosed(tmp_path / "out", capsys, broken), *message)


@pytest.mark.parametrize(
    "file, change, message",
    [
        ("frames.csv", lambda lines: lines[: len(lines) // 2], ["frames.csv stops at 1", "mallet.csv goes on"]),
        ("mallet.csv", lambda lines: lines[: len(lines) // 2], ["mallet.csv stops at 15.0 s", "frames.csv goes on"]),
        ("commands.csv", lambda lines: lines[: len(lines) // 2], ["commands.csv stops at", "mallet.csv goes on"]),
        ("mallet.csv", _restamp(lambda t: t + 3.0 * (t > 15.3)), ["mallet.csv jumps by 3000 ms at 15.30 s"]),
        ("mallet.csv", lambda lines: lines[:5001] + lines[6501:], ["mallet.csv has no row for 3.0 s from 10.0 s"]),
    ],
    ids=["no camera", "no encoders", "no commands", "leap", "pause"],
)
def test_streams_that_contradict_each_other_are_undetermined(rally, tmp_path, capsys, file, change, message):
    broken = _change(rally, tmp_path / "broken", file, change)
    _undetermined(_diagnosed(tmp_path / "out", capsys, broken), *message)


def test_commands_may_end_when_the_mallet_rests(rally, tmp_path):
    def rest(lines):
        last = next(line for line in lines[1:] if float(line.split(",")[0]) >= 10.0).split(",")[1:]
        return [line if float(line[:5]) < 10.0 else ",".join([line.split(",")[0], *last]) for line in lines[1:]]

    resting = _change(rally, tmp_path / "resting", "mallet.csv", lambda lines: [lines[0], *rest(lines)])
    early = _change(resting, tmp_path / "early", "commands.csv", lambda lines: lines[:101])
    check_usable([read_recording(early)])
    with pytest.raises(UndeterminedError, match=r"stops at 9\.9 s"):
        check_usable([read_recording(_change(rally, tmp_path / "moving", "commands.csv", lambda lines: lines[:101]))])


@pytest.mark.parametrize(
    "file, change, message",
    [
        ("frames.csv", lambda lines: [*lines[:900], lines[900][:12]], "frames.csv:901: has 2 cells, expected 5"),
        ("frames.csv", _restamp(lambda t: t - 2.0 * (t > 15.0)), "the clock goes back"),
        ("meta.json", lambda lines: lines[: len(lines) // 2], "meta.json"),
    ],
    ids=["half a row", "back in time", "half the meta data"],
)
def test_a_file_that_breaks_a_rule_gets_one_line(tilted, tmp_path, capsys, file, change, message):
    broken = _change(tilted, tmp_path / "broken", file, change)
    assert main(["diagnose", str(broken), "--out", str(tmp_path / "out")]) == 2
    error = capsys.readouterr().err
    assert message in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


def test_pauses_are_noted(tilted, tmp_path, capsys):
    """The data before and after a gap of the camera are diagnosed."""
    paused = _change(tilted, tmp_path / "paused", "frames.csv", lambda lines: lines[:2000] + lines[2300:])
    expected = _diagnosed(tmp_path / "out", capsys, paused)
    assert expected["notes"] == ["paused: frames.csv has 1 pause of more than 0.5 s and is cut there"]
    assert [one["mechanism"] for one in expected["findings"]] == ["table_tilt"]


def test_all_streams_may_pause_together(rally, tmp_path):
    """As when a table was stopped: no clock can have jumped alone then."""
    paused = rally
    for file in ("frames.csv", "mallet.csv", "commands.csv"):
        without = lambda lines: [*lines[:1], *(one for one in lines[1:] if not 10.0 < float(one.split(",")[0]) < 11.0)]  # noqa: E731
        paused = _change(paused, tmp_path / file.split(".")[0], file, without)
    check_usable([read_recording(paused)])


def test_the_recordings_as_they_are_can_be_used(tilted, rally):
    check_usable([read_recording(tilted), read_recording(rally)])
