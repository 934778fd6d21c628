"""`puckpilot track`, from rendered pictures of a game in a folder to a recording held against the game itself."""

from __future__ import annotations

import json
import re
from dataclasses import replace
from itertools import islice
from pathlib import Path
from time import perf_counter

import cv2
import numpy as np
import pytest

import puckpilot
from sim2real.camera import sources, valid_frames
from sim2real.camera.frame import Frame
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.scene_states import simulated_states
from sim2real.recording.folder import read_recording
from sim2real.vision.calibrate.table_file import write_table
from sim2real.vision.trial.rendered_calibration import estimated_calibration

TABLE = Table.with_markers()
VIEW = CameraView.like_the_real_one(TABLE.length, TABLE.width)
RENDERER = Renderer(TABLE, VIEW)
RATE = 120.0


@pytest.fixture(scope="module")
def calibration(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A calibration as a user would come by it."""
    file = tmp_path_factory.mktemp("calibration") / "table.json"
    write_table(file, *estimated_calibration(TABLE, VIEW, seed=3))
    return file


def folder_of(images: list[np.ndarray], folder: Path, numbers: list[int] | None = None) -> Path:
    folder.mkdir()
    for number, image in zip(numbers or range(len(images)), images, strict=True):
        cv2.imwrite(str(folder / f"frame_{number:04}.png"), image, [cv2.IMWRITE_PNG_COMPRESSION, 1])
    return folder


def still(pictures: int) -> list[np.ndarray]:
    state = SceneState(puck=BodyState(1.0, 0.3), opponent=BodyState(1.6, 0.5))
    return [RENDERER.picture(state, number) for number in range(pictures)]


def run(calibration: Path, source: Path | str, out: Path, *more: str) -> int:
    return puckpilot.main(["track", str(source), "--calibration", str(calibration), "--out", str(out), *more])


@pytest.mark.slow
def test_a_game_in_a_folder_becomes_a_recording(calibration: Path, tmp_path: Path, capsys):
    """Positions are within the errors of the calibration, and blank where nobody could know."""
    game = list(islice(simulated_states("puckpilot/match-v0", ("veteran", "follower"), 0, RATE), 90))
    folder = folder_of([RENDERER.picture(state, k) for k, state in enumerate(game)], tmp_path / "pictures")
    film = tmp_path / "preview.mp4"
    assert run(calibration, folder, tmp_path / "out", "--video", str(film), "--json") == 0
    output = json.loads(capsys.readouterr().out)
    assert output["frames"] == 90 == output["seen"] + output["hidden"] + output["unsure"] and output["dropped"] == 0
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None
    assert frames.t == pytest.approx(np.arange(90) / RATE)
    for name in ("puck", "opponent"):
        truth = np.array([getattr(state, name)[:2] for state in game])
        found = np.stack([frames[f"{name}_x"], frames[f"{name}_y"]], axis=1)
        far = 1e3 * np.linalg.norm(found - truth, axis=1)
        assert np.isfinite(far).sum() >= 75 and np.isnan(far[0])
        assert np.nanmean(far) < 0.3 and np.nanmax(far) < 1.5
    video = cv2.VideoCapture(str(film))
    assert int(video.get(cv2.CAP_PROP_FRAME_COUNT)) == 19  # 25 a second of 0.75 s
    assert puckpilot.main(["compare", str(tmp_path / "out"), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)


def test_what_is_wrong_is_named_and_ends_with_1(calibration: Path, tmp_path: Path, capsys):
    """At 10 Hz, so that the pixels are looked at every fifth picture."""
    images = still(12)
    images[3] = images[3][:-2]
    for image in images[4:7]:
        image[:200] = 255
    images[8] = images[7]
    images[9][::2, ::2] //= 2
    numbers = [*range(9), *range(11, 14)]
    assert run(calibration, folder_of(images, tmp_path / "pictures", numbers), tmp_path / "out", "--rate", "10") == 1
    lines = capsys.readouterr().out.splitlines()
    assert lines[0].startswith("12 frames: ") and lines[0].endswith("; 2 dropped, 2 left out")
    assert lines[1].startswith("camera found by 5 markers, 0.0")
    expected = (
        "wrong size, once from 0.3 s on: a picture has 1440 x 1078 pixels; expected 1440 x 1080",
        "over-exposed, once from 0.5 s on: ",
        "repeated, once from 0.8 s on: ",
        "colour mosaic, once from 1.1 s on: ",
    )
    assert all(any(line.startswith(words) for line in lines) for words in expected) and len(lines) == 8
    recording = read_recording(tmp_path / "out")
    assert recording.frames is not None and recording.frames.rows == 10
    assert all(words in recording.meta["note"] for words in expected)


def test_its_options_are_heard(calibration: Path, tmp_path: Path, capsys):
    """A ring at 40 mm is seen elsewhere than at 90, as its camera's height has it."""
    folder, places = folder_of(still(3), tmp_path / "pictures"), []
    for name, more in (("standard", ()), ("low", ("--ring-height", "low")), ("metres", ("--ring-height", "0.04"))):
        assert run(calibration, folder, tmp_path / name, *more) == 0
        frames = read_recording(tmp_path / name).frames
        assert frames is not None
        places.append(np.array([frames["opponent_x"][-1], frames["opponent_y"][-1]]))
    lower = (0.09 - 0.04) / (VIEW.place[2] - 0.09)
    np.testing.assert_allclose(places[1] - places[0], lower * (places[0] - VIEW.place[:2]), atol=1e-3)
    np.testing.assert_array_equal(places[2], places[1])
    assert run(calibration, folder, tmp_path / "dark", "--level", "250") == 1
    assert run(calibration, folder, tmp_path / "small", "--puck-radius", "0.02") == 1
    assert capsys.readouterr().out.count("no puck, ") == 2
    assert read_recording(tmp_path / "small").meta["puck"] == {"radius_m": 0.02}


def test_after_a_bump_the_camera_is_found_anew(calibration: Path, tmp_path: Path, capsys):
    """At 10 Hz the markers are looked at every half second: 0.5, 1.0, then the bump, 1.5, ..."""
    images = still(13)
    elsewhere = Renderer(
        TABLE, CameraView.from_place(VIEW.place + np.array([0.0, 0.01, 0.0]), np.array([0.61, 0.51, 0.0]))
    )
    bumped = [
        elsewhere.picture(SceneState(puck=BodyState(1.0, 0.3), opponent=BodyState(1.6, 0.5)), 20 + k) for k in range(11)
    ]
    folder = folder_of([*images, *bumped], tmp_path / "pictures")
    assert run(calibration, folder, tmp_path / "out", "--rate", "10") == 1
    output = capsys.readouterr().out
    shift = re.search(r"moved camera, once from 1.5 s on: 5 of 5 markers are up to (\S+) px", output)
    corners = np.stack([marker.corners for marker in TABLE.markers])
    off = [elsewhere.view.project(one) - VIEW.project(one) for one in corners]
    assert shift and float(shift[1]) == pytest.approx(np.hypot(*np.median(off, axis=1).T).max(), abs=0.2)
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None
    known = np.isfinite(frames["puck_x"])
    assert known[1:10].all() and not known[11:15].any() and known[17:].all()
    assert output.splitlines()[0].endswith(" 0 dropped, 5 left out")  # from 1.0 s, the last good check, to 1.5
    assert np.abs(frames["puck_x"][known] - 1.0).max() < 1e-3 and np.abs(frames["puck_y"][known] - 0.3).max() < 1e-3


def test_a_lamp_that_goes_out_is_named_and_places_from_then_on_are_blank(calibration: Path, tmp_path: Path, capsys):
    dark = [np.random.default_rng(k).integers(0, 4, (1080, 1440), np.uint8) for k in range(6)]
    assert run(calibration, folder_of([*still(6), *dark], tmp_path / "pictures"), tmp_path / "out", "--rate", "10") == 1
    assert "markers lost, once from 1.0 s on: no marker is seen where it was" in capsys.readouterr().out
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None
    np.testing.assert_array_equal(np.isfinite(frames["puck_x"]), [False, *[True] * 5, *[False] * 6])


def test_a_puck_that_is_now_here_now_there_is_named(calibration: Path, tmp_path: Path, capsys):
    places = np.random.default_rng(0).uniform((0.9, 0.1), (1.8, 0.9), (24, 2))
    images = [RENDERER.picture(SceneState(puck=BodyState(*place)), k) for k, place in enumerate(places.tolist())]
    assert run(calibration, folder_of(images, tmp_path / "pictures"), tmp_path / "out", "--json") == 1
    output = json.loads(capsys.readouterr().out)
    assert output["unsure"] > 17 and output["left_out"] == 0 and list(output["troubles"]) == ["not sure"]


def test_a_table_on_which_no_puck_is_seen_is_named(calibration: Path, tmp_path: Path, capsys):
    images = [RENDERER.picture(SceneState(opponent=BodyState(1.6, 0.5)), k) for k in range(3)]
    assert run(calibration, folder_of(images, tmp_path / "pictures"), tmp_path / "out") == 1
    output = capsys.readouterr().out
    assert "no puck, once from 0.0 s on: it was known in no picture; see that its film shines" in output


def test_rendered_pictures_need_no_calibration(tmp_path: Path, capsys):
    assert puckpilot.main(["track", "synthetic", "--out", str(tmp_path / "out"), "--seconds", "0.05"]) == 0
    assert capsys.readouterr().out.startswith("6 frames: puck known in 5, ")
    assert puckpilot.main(["track", str(tmp_path), "--out", str(tmp_path / "other")]) == 2
    assert "--calibration is missing; give the table.json" in capsys.readouterr().err


class Stalling:
    """A live camera that gives three pictures and then no more."""

    over, total = False, None

    def __init__(self, images: list[np.ndarray], back: int = 0) -> None:
        """`back`: frames by which its clock once jumps back, before the third picture."""
        times = [(k - (back if k == 2 else 0)) / RATE for k in range(len(images))]
        self._frames = [Frame(image, t, t, k) for k, (t, image) in enumerate(zip(times, images, strict=True))]

    def newest(self, wait: float) -> Frame | None:
        return replace(self._frames.pop(0), host_time=perf_counter()) if self._frames else None

    def __enter__(self) -> Stalling:
        return self

    def __exit__(self, *_: object) -> None:
        pass


def test_a_camera_that_stalls_is_named_and_what_was_seen_is_kept(
    calibration: Path, tmp_path: Path, monkeypatch, capsys
):
    monkeypatch.setattr(sources, "open_source", lambda word, settings: Stalling(still(3)))
    monkeypatch.setattr(valid_frames, "PATIENCE", 0.2)
    assert run(calibration, "device:0", tmp_path / "out") == 1
    output = capsys.readouterr().out
    lines = output.splitlines()
    assert lines[0] == "3 frames: puck known in 2, hidden in 0, not sure in 1; 0 dropped" and len(lines) == 5
    assert lines[3].startswith("stalled, ") and "no picture for 0.2 s" in lines[3]
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None and frames.t == pytest.approx(np.arange(3) / RATE)  # the camera's clock, not the host's


def test_what_was_seen_before_a_source_fails_is_kept(calibration: Path, tmp_path: Path, capsys):
    folder = folder_of(still(5), tmp_path / "pictures")
    damaged = folder / "frame_0003.png"
    damaged.write_bytes(damaged.read_bytes()[:5000])
    assert run(calibration, folder, tmp_path / "out") == 1
    output = capsys.readouterr().out
    assert (
        output.startswith("3 frames: ")
        and "source failed, once from 0.0 s on: " in output
        and "frame_0003.png is cut off" in output
    )
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None and frames.rows == 3


def test_a_clock_that_runs_back_is_named_and_that_picture_left_out(
    calibration: Path, tmp_path: Path, monkeypatch, capsys
):
    monkeypatch.setattr(sources, "open_source", lambda word, settings: Stalling(still(4), back=5))
    monkeypatch.setattr(valid_frames, "PATIENCE", 0.02)
    assert run(calibration, "device:0", tmp_path / "out") == 1
    assert "clock, once from 0.0 s on: a picture of -0.025000 s came after one of 0.008333 s" in capsys.readouterr().out
    frames = read_recording(tmp_path / "out").frames
    assert frames is not None and frames.rows == 3


def test_only_so_many_seconds_are_taken(calibration: Path, tmp_path: Path, capsys):
    folder = folder_of(still(6), tmp_path / "pictures")
    for seconds in ("0.025", "0.03"):
        assert run(calibration, folder, tmp_path / seconds, "--rate", "100", "--seconds", seconds) == 0
        assert capsys.readouterr().out.startswith("3 frames: ")
    assert read_recording(tmp_path / "0.03").meta["camera"]["rate_hz"] == 100.0


def test_what_cannot_be_is_refused_in_one_line(calibration: Path, tmp_path: Path, capsys):
    empty = folder_of([np.zeros((1080, 1440), np.uint8)], tmp_path / "dark")
    small = folder_of([np.zeros((480, 640), np.uint8)], tmp_path / "small")
    good = folder_of(still(1), tmp_path / "good")
    for source, more, why in (
        (empty, (), "the camera cannot be located in the first picture: 0 markers of DICT_4X4_50 are seen"),
        (small, (), "a picture has 640 x 480 pixels; expected 1440 x 1080, as calibrated"),
        (good, ("--ring-height", "high"), "--ring-height is 'high'; expected standard, low, or metres from 0 to 0.3"),
        (good, ("--puck-radius", "30"), "--puck-radius is 30; expected metres from 0.005 to 0.1"),
        (good, ("--level", "0"), "--level is 0; expected a grey level from 1 to 250"),
        (good, ("--seconds", "-1"), "--seconds is -1; expected a number above 0"),
        (good, ("--video", "film.avi"), "cannot write 'film.avi' as a film"),
        (tmp_path / "nowhere", (), "is no source of pictures"),
    ):
        assert run(calibration, source, tmp_path / "out", *more) == 2
        error = capsys.readouterr().err
        assert error.count("\n") == 1 and why in error
    assert not (tmp_path / "out").exists()
    (tmp_path / "out").mkdir()
    assert run(calibration, good, tmp_path / "out") == 2
    assert "exists already" in capsys.readouterr().err
