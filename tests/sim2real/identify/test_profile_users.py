"""Who loads a profile: the board's configuration, the diagnosis's baseline, and both commands that write one."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

import puckpilot
from puckpilot_env.options.effects_file import described
from puckpilot_env.options.profile_file import read_profile
from puckpilot_env.parameters import make_records
from sim2real.identify.gantry import choose
from sim2real.identify.gantry.law import STEPS
from sim2real.recording.folder import write_recording
from sim2real.recording.table_parameters import read_baseline
from sim2real.table.board_config import board_config
from tests.places import ROOT
from tests.puckpilot_env.options.test_profile_file import CONSTANTS, PROFILE
from tests.sim2real.identify.gantry.simulated import log


def test_the_board_is_configured_with_its_constants() -> None:
    config = board_config(make_records(1, PROFILE.parameters)[0])
    assert config.c6 == pytest.approx((CONSTANTS["a2"] - CONSTANTS["b2"], CONSTANTS["a2"] + CONSTANTS["b2"]))
    assert config.c7 == pytest.approx((CONSTANTS["a3"] - CONSTANTS["b3"], CONSTANTS["a3"] + CONSTANTS["b3"]))
    assert config.pulley_radius == CONSTANTS["pulley_radius"]


@pytest.mark.slow
def test_a_gantry_is_identified_and_its_profile_loaded(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(choose, "STEPS", STEPS[:2])
    for seed in (1, 2, 3):
        write_recording(tmp_path / f"log_{seed}", log(seed, 4.0, push=0.1))
    out, folders = tmp_path / "gantry.toml", [str(tmp_path / f"log_{seed}") for seed in (1, 2)]
    words = ["identify", "gantry", *folders, "--holdout", str(tmp_path / "log_3"), "--out", str(out), "--json"]
    assert puckpilot.main(words) == 0
    answer, profile = json.loads(capsys.readouterr().out), read_profile(out)
    assert answer["parameters"] == profile.parameters == read_baseline(out)
    assert (profile.recordings, profile.holdout) == (("log_1", "log_2"), ("log_3",))
    assert {"log_3"} == set(profile.laws[profile.chosen].rms) == set(answer["tried"][0]["rms_m"])
    assert profile.parameters["pulley_radius"] == 0.0357 and profile.laws["third_order"].values["c6_x"].determined
    assert any("a2 0.00" in line for line in described(out))  # as --effects tells it


@pytest.mark.slow
def test_a_puck_is_identified_as_the_diagnosis_refits_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    out = tmp_path / "puck.toml"
    assert puckpilot.main(["identify", "puck", str(ROOT / "sim2real/demo_recording"), "--out", str(out)]) == 0
    text, profile = capsys.readouterr().out, read_profile(out)
    assert profile.of == "puck" and {"friction", "drag", "wall_restitution"} <= set(profile.laws["baseline"].values)
    assert f"wrote {out}" in text and "glide: rms" in text
    drawn = {draw.parameter: (draw.low, draw.high) for draw in profile.draws}
    low, high = drawn["wall_restitution"]
    assert low < profile.parameters["wall_restitution"] < high and read_baseline(out) == profile.parameters


@pytest.mark.parametrize(
    ("words", "message"),
    [
        (["gantry", "none"], "none: is not a folder"),
        (["gantry", "{demo}", "--out", "{tmp}"], "it is a folder; expected a file"),
        (["gantry", "{demo}", "{demo}"], "is given twice"),
        (["puck", "{log}"], "too little data: 1.0 s in total; record at least one minute without a pause"),
    ],
)
def test_what_cannot_be_identified_is_refused_in_one_line(
    words: list[str], message: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    places = {"{demo}": str(ROOT / "sim2real/demo_recording"), "{tmp}": str(tmp_path), "{log}": str(tmp_path / "log")}
    if "{log}" in words:
        write_recording(tmp_path / "log", log(1, 1.0))
    assert puckpilot.main(["identify", *(places.get(word, word) for word in words)]) == 2
    found = capsys.readouterr()
    assert found.err.count("\n") == 1 and not found.out
    assert message in found.err
