"""Fault drills at the twin: each fault is noticed by its cause, the mallet stops in time, and play goes on."""

from __future__ import annotations

import json
from concurrent.futures import ThreadPoolExecutor
from dataclasses import asdict
from math import nan
from pathlib import Path

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot
from sim2real.table.drills import campaign
from sim2real.table.drills.campaign import Part, conditions, run_campaign
from sim2real.table.drills.drill import Drill, Stop
from sim2real.table.drills.faults import FAULTS, Fault
from sim2real.table.drills.picture_faults import PICTURE_FAULTS
from sim2real.table.game.robot_seat import make_robot_seat

LONG = ("dark", "glare", "hand", "camera-knocked", "second-puck")  # of those that pictures show


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "camera"),
    [
        *((fault, "places") for fault in FAULTS),
        *(
            pytest.param(fault, "pictures", marks=[pytest.mark.long] if fault.name in LONG else [])
            for fault in PICTURE_FAULTS
        ),
    ],
    ids=lambda one: getattr(one, "name", ""),
)
def test_a_fault_stops_the_mallet_and_play_goes_on_after_clear(fault: Fault, camera: str) -> None:
    env = make_robot_seat("puckpilot/match-v0", "twin", opponent="interceptor", camera=camera)
    try:
        drill = Drill(env, "interceptor", seed=5)
        drill.play(1.0)
        stop = drill.let_happen(fault, within=0.03)
        assert stop.cause in (fault.causes or {""})  # of some play goes on
        assert stop.in_time
        drill.play(1.0)
        assert drill.monitor.worst.volts <= 15.0 and drill.monitor.worst.outside <= 0.0
    finally:
        env.close()


@pytest.mark.parametrize(
    ("stop", "in_time"),
    [
        (Stop("cable", "port lost", 0.0, 0.045, 3.0), True),
        (Stop("cable", "port lost", 0.0, 0.055, 3.0), False),
        (Stop("cable", "", nan, 0.0, 3.0), False),  # nobody noticed
        (Stop("no-puck", "", nan, 0.0, 3.0), True),  # it may come back by itself
        (Stop("no-puck", "puck lost", 2.0, 2.045, 3.0), True),
        (Stop("no-puck", "puck lost", 2.0, 2.055, 3.0), False),
    ],
)
def test_a_stop_in_time_is_noticed_and_soon(stop: Stop, in_time: bool) -> None:
    assert stop.in_time == in_time


def test_parts_of_another_campaign_are_not_taken_for_this_ones(tmp_path: Path) -> None:
    path = tmp_path / "drill.jsonl"
    part = Part(0, 120.0, [], 15.0, 0.0, "", conditions(["cable"], "goalie", "places"))
    path.write_text(json.dumps(asdict(part)) + "\n")
    again = run_campaign(path, 60.0, 0, ["cable"], "goalie", "places", 1, lambda done, of: None)
    assert again == [part]
    for names, player, camera in ((["noise"], "goalie", "places"), (["cable"], "still", "places")):
        with pytest.raises(
            ValueError, match=r"has parts of another campaign, goalie, places, code \w+: cable; .*--out"
        ):
            run_campaign(path, 60.0, 0, names, player, camera, 1, lambda done, of: None)


@pytest.mark.parametrize("left", [1, 5, 60, -1])  # characters of the line that was being written
def test_a_line_that_was_cut_off_is_played_again(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, left: int) -> None:
    path = tmp_path / "drill.jsonl"
    first, second = (Part(seed, 120.0, [], 15.0, 0.0, "", conditions(["cable"], "goalie", "places")) for seed in (0, 1))
    lines = [json.dumps(asdict(part)) + "\n" for part in (first, second)]
    path.write_text(lines[0] + lines[1][:left])
    monkeypatch.setattr(campaign, "ProcessPoolExecutor", ThreadPoolExecutor)
    monkeypatch.setattr(campaign, "play_part", lambda seed, names, player, camera: second)
    found = run_campaign(path, 240.0, 0, ["cable"], "goalie", "places", 1, lambda done, of: None)
    assert found == [first, second] and path.read_text() == "".join(lines)


@pytest.mark.parametrize("text", ["notes without an end", '[{"seed": 1}]', '{"seed": 1}\nnotes'])
def test_a_file_of_something_else_is_refused_and_stays(tmp_path: Path, text: str) -> None:
    path = tmp_path / "notes.txt"
    path.write_text(text)
    with pytest.raises(ValueError, match="is no part of a campaign; choose another file"):
        run_campaign(path, 60.0, 0, ["cable"], "goalie", "places", 1, lambda done, of: None)
    assert path.read_text() == text


def test_a_fault_of_pictures_without_pictures_says_so(capsys: pytest.CaptureFixture[str]) -> None:
    assert puckpilot.main(["table", "drill", "hand", "--minutes", "1"]) == 2
    assert "'hand' is a fault that only pictures show; give --camera pictures" in capsys.readouterr().err
