"""`table.toml`: what it holds, and what is refused in one line before anything moves."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

import puckpilot
from puckpilot_env.options.profile_file import write_profile
from sim2real.camera.region import RegionOfInterest
from sim2real.table.physical.table_file import EXAMPLE, read_table_file
from tests.puckpilot_env.options.test_profile_file import PROFILE

LEAST = """
format = "puckpilot-table/1"
[camera]
source = "device:0"
calibration = "table.json"
[board]
port = "/dev/ttyUSB0"
"""


def written(folder: Path, text: str) -> Path:
    file = folder / "table.toml"
    file.write_text(text)
    return file


def test_the_example_is_read_with_all_that_it_says(tmp_path: Path) -> None:
    left_out = ("film_radius", "pulley_radius", "offsets", "command_delay")  # until they are measured
    found = read_table_file(written(tmp_path, EXAMPLE))
    assert found.board.offsets is None and found.camera.film_radius is None and found.board.command_delay == 0.0
    text = EXAMPLE
    for name in left_out:
        text = text.replace(f"# {name}", name)
    found = read_table_file(written(tmp_path, text))
    assert found.camera.film_radius == 0.0309 and found.board.command_delay == 0.003
    assert found.parameters["length"] == 2.362 and found.parameters["max_voltage"] == 24.0
    assert found.parameters["pulley_radius"] == 0.0353 and found.board.offsets == (0.51, -1.22)
    assert found.camera.settings.region == RegionOfInterest(396, 20, 1300, 1450) and found.camera.settings.mosaic
    assert found.camera.calibration == tmp_path / "table.json" and found.camera.delay == 0.006
    assert found.board.gains.proportional == (400.0, 400.0) and found.board.gains.derivative == (2.0, 2.0)


def test_the_section_that_latency_prints_gives_the_delays_of_camera_and_commands(tmp_path: Path) -> None:
    text = LEAST + "[latency]\ndelay = 0.0354\ncamera = 0.0324\nframe = 0.0389\ntotal = 0.0529\ncommand = 0.0031\n"
    found = read_table_file(written(tmp_path, text))
    assert found.camera.delay == 0.0354 and found.board.command_delay == 0.0031
    found = read_table_file(written(tmp_path, text.replace("0.0031", "-1e-5")))
    assert found.board.command_delay == 0.0  # none, as far as it was measured


def test_a_profile_of_a_puck_is_not_the_gantrys(tmp_path: Path) -> None:
    write_profile(tmp_path / "puck.toml", replace(PROFILE, of="puck"))
    with pytest.raises(ValueError, match=r"gantry.profile is of a puck; expected one of puckpilot identify gantry"):
        read_table_file(written(tmp_path, LEAST + '[gantry]\nprofile = "puck.toml"\n'))


def test_what_is_left_out_has_the_default(tmp_path: Path) -> None:
    found = read_table_file(written(tmp_path, LEAST))
    assert found.parameters == {} and found.board.offsets is None and found.camera.setup is None


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('port = "/dev/ttyUSB0"', ""), "board.port is missing"),
        (('source = "device:0"', ""), "camera.source is missing"),
        (('format = "puckpilot-table/1"', ""), "there is no line with its format"),
        (("[board]", "[bord]"), "unknown entry 'bord'; did you mean 'board'?"),
        (("[board]", "[board]\nsuply = 24.0"), "unknown key of board 'suply'; did you mean 'supply'?"),
        (("[board]", "[board]\nsupply = 2400.0"), "max_voltage"),
        (("[board]", "[board]\noffsets = [1.0]"), "board.offsets is [1.0]; expected two numbers"),
        (("[board]", '[board]\nbaud = "fast"'), "board.baud is 'fast'; expected a whole number above 0"),
        (("[camera]", '[camera]\nregion = "12"'), "a region of interest is '12'"),
        (("[camera]", "[camera]\ndelay = -1.0"), "camera.delay is -1.0; expected a number, 0 or more"),
        (("[camera]", "[camera]\nfilm_radius = 5.0"), "camera.film_radius is 5.0; expected metres from 0.005 to 0.1"),
        (("[camera]", "[camera]\nring_height = 9"), "camera.ring_height is 9; expected metres from 0 to 0.3"),
        (("[camera]", '[camera]\nring_height = "low"'), "camera.ring_height is 'low'; expected metres from 0 to 0.3"),
        (("[camera]", "[camera]\nlevel = 900"), "camera.level is 900; expected a grey level from 1 to 250"),
        (("[board]", "[board]\noffsets = [nan, 0.0]"), "board.offsets is [nan, 0.0]; expected two numbers"),
        (
            ("[board]", "[board]\nproportional = [400.0, -1.0]"),
            "board.proportional is [400.0, -1.0]; expected two numbers from 0 to 10000",
        ),
        (("[board]", "[board]\nintegral = [1e6, 0.0]"), "expected two numbers from 0 to 100000"),
        (("[board]", "[board]\nderivative = [-2.0, 2.0]"), "expected two numbers from 0 to 1000"),
        (("[camera]", "[camera]\nrate = 0.0"), "rate is 0.0; expected frames a second"),
        (("[camera]", '[camera]\nexposure = "x"'), "camera.exposure is 'x'; expected a number, 0 or more"),
        (("[board]", "[latency]\nfram = 0.01\n[board]"), "unknown key of latency 'fram'; did you mean 'frame'?"),
        (("[board]", '[latency]\nframe = "nonsense"\n[board]'), "latency.frame is 'nonsense'; expected a number"),
        (
            ("[board]", "[latency]\ndelay = 0.01\ncommand = 0.003\n[board]\ncommand_delay = 0.003"),
            "command_delay is given under [board], and command under [latency]; keep the newer one",
        ),
        (
            ("[board]", "[board]\ncommand_delay = 0.02"),
            "board.command_delay is 0.02; expected a number, 0 to 0.01",
        ),
        (("[board]", "[latency]\nframe = 0.01\n[board]"), "[latency] has no delay of the camera; measure it again"),
        (
            ("[board]", "delay = 0.006\n[latency]\ndelay = 0.01\n[board]"),
            "under [camera] and under [latency]; keep the",
        ),
        (
            ("[board]", 'setup = "a.png"\nsetup_exposure = 8e-3\n[board]'),
            "are given; keep one: a picture that is there",
        ),
        (("[board]", '[gantry]\nprofile = "none.toml"\n[board]'), "none.toml"),
    ],
)
def test_a_file_that_cannot_be_used_is_refused_in_one_line(tmp_path: Path, change: tuple[str, str], words: str) -> None:
    file = written(tmp_path, LEAST.replace(*change))
    with pytest.raises(ValueError) as caught:
        read_table_file(file)
    assert words in str(caught.value) and str(file) in str(caught.value) and "\n" not in str(caught.value)


def test_commands_refuse_a_table_without_calibration_before_anything_moves(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    file = str(written(tmp_path, LEAST))
    for words in (["table", "check", file], ["play", "goalie", "--backend", "table", "--table", file]):
        assert puckpilot.main(words) == 2
        error = capsys.readouterr().err
        assert "table.json" in error and error.count("\n") == 1


def test_play_asks_for_what_its_backend_needs(capsys: pytest.CaptureFixture[str]) -> None:
    for words, message in (
        (["--backend", "table"], "--backend table needs --table"),
        (["--backend", "replay"], "--backend replay needs --recording"),
        (["--backend", "replay", "--opponent", "goalie"], "--opponent is given with --backend replay"),
    ):
        assert puckpilot.main(["play", "goalie", *words]) == 2
        assert message in capsys.readouterr().err
