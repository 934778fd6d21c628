"""Folders and videos, played back whole and in order; what is damaged or of the wrong kind is named."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import cv2
import numpy as np
import pytest
from PIL import Image

from sim2real.camera.frame import CameraError, Frame, Source
from sim2real.camera.settings import CameraSettings
from sim2real.camera.sources import KNOWN, open_source


def save(folder: Path, name: str, level: int, mode: str = "L") -> Path:
    """A picture of 40 x 30 pixels of one level."""
    Image.fromarray(np.full((30, 40), level, np.uint8)).convert(mode).save(folder / name)
    return folder / name


def play(source: Source) -> list[Frame]:
    """All its frames."""
    frames = []
    with source:
        while not source.over:
            frames.append(source.newest(0.0))
        assert source.newest(0.0) is None
    return [frame for frame in frames if frame]


def test_numbers_in_names_are_sequence_numbers(tmp_path: Path) -> None:
    for number in (10, 9, 12):  # as text, 10 would come before 9
        save(tmp_path, f"frame_{number}.png", number)
    (tmp_path / "notes.txt").write_text("no picture")
    frames = play(open_source(str(tmp_path), CameraSettings(rate=50.0)))
    assert [(f.sequence, f.dropped, f.image[3, 4]) for f in frames] == [(9, 0, 9), (10, 0, 10), (12, 1, 12)]
    assert [f.time for f in frames] == pytest.approx([0.18, 0.20, 0.24])
    assert frames[0].image.shape == (30, 40) and frames[0].image.dtype == np.uint8
    assert frames[0].host_time == frames[0].time


@pytest.mark.parametrize("names", [("b.png", "a.png", "c1.png"), ("x1.png", "x1.bmp", "x2.png")])
def test_without_numbers_of_their_own_names_are_in_order(tmp_path: Path, names: tuple[str, ...]) -> None:
    for level, name in enumerate(sorted(names)):
        save(tmp_path, name, level)
    frames = play(open_source(f"{tmp_path}/", CameraSettings(rate=10.0)))
    assert [(f.sequence, f.dropped, f.image[0, 0]) for f in frames] == [(0, 0, 0), (1, 0, 1), (2, 0, 2)]


def test_pictures_that_cannot_be_taken_are_named(tmp_path: Path) -> None:
    with pytest.raises(CameraError, match="holds no picture"):
        open_source(str(tmp_path))
    picture = save(tmp_path, "1.png", 7)
    whole = picture.read_bytes()
    picture.write_bytes(whole[: len(whole) // 2])
    with pytest.raises(CameraError, match=r"1\.png is cut off or damaged"):
        open_source(str(tmp_path))
    picture.write_bytes(b"nothing of the kind")
    with pytest.raises(CameraError, match=r"1\.png cannot be read as a picture"):
        open_source(str(tmp_path))
    for mode, kind in (("RGB", "a colour image"), ("I;16", "an image of mode I;16")):
        save(tmp_path, "1.png", 7, mode)
        with pytest.raises(CameraError, match=rf"1\.png is {kind}; expected 8-bit grey"):
            open_source(str(tmp_path))
    save(tmp_path, "1.png", 7)


def test_what_comes_before_a_damaged_picture_is_given(tmp_path: Path) -> None:
    save(tmp_path, "1.png", 7)
    save(tmp_path, "2.png", 7, "RGB")
    save(tmp_path, "3.png", 7)
    with open_source(str(tmp_path)) as source:
        frame = source.newest(0.0)
        assert frame is not None and frame.sequence == 1 and not source.over
        with pytest.raises(CameraError, match=r"2\.png"):
            source.newest(0.0)
        assert source.over


def film(path: Path, levels: list[int]) -> Path:
    """A video of 64 x 48 pixels, 60 a second, each picture of one level."""
    writer = cv2.VideoWriter(str(path), cv2.VideoWriter.fourcc(*"MJPG"), 60.0, (64, 48))
    for level in levels:
        writer.write(np.full((48, 64, 3), level, np.uint8))
    writer.release()
    return path


def test_a_video_is_played_at_its_own_rate_or_the_one_given(tmp_path: Path) -> None:
    path = film(tmp_path / "game.avi", [20, 90, 160])
    assert [frame.time for frame in play(open_source(str(path), CameraSettings(rate=240.0)))] == [0.0, 1 / 240, 2 / 240]
    frames = play(open_source(str(path)))
    assert [(f.sequence, f.dropped) for f in frames] == [(0, 0), (1, 0), (2, 0)]
    assert [f.time for f in frames] == pytest.approx([0.0, 1 / 60, 2 / 60], rel=1e-4)
    assert [float(f.image.mean()) for f in frames] == pytest.approx([20, 90, 160], abs=2)
    assert frames[0].image.shape == (48, 64)


def test_a_video_that_ends_before_its_end_is_named(tmp_path: Path) -> None:
    path = film(tmp_path / "game.avi", [20] * 40)
    whole = path.read_bytes()
    path.write_bytes(whole[: len(whole) // 2])
    given = 0
    with (
        open_source(str(path)) as source,
        pytest.raises(CameraError, match=r"cut off or damaged: \d+ of its 40 frames"),
    ):
        while source.newest(0.0):
            given += 1
    assert 5 < given < 30


def test_files_that_are_no_video_are_named(tmp_path: Path) -> None:
    path = tmp_path / "game.mp4"
    path.write_bytes(bytes(range(256)) * 8)
    with pytest.raises(CameraError, match=r"game\.mp4: is no video"):
        open_source(str(path))


def test_a_recording_to_render_is_named() -> None:
    with pytest.raises(CameraError, match="synthetic: names no recording"):
        open_source("synthetic:")


@pytest.mark.parametrize("word", ["nowhere.mp4", "", "device", "aravis", "webcam:0"])
def test_an_unknown_word_is_answered_with_the_known_ones(word: str, tmp_path: Path, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    with pytest.raises(CameraError) as error:
        open_source(word or "/nowhere/")
    assert KNOWN in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize("word", ["device:", "device:x", "device:-1"])
def test_a_device_is_a_number(word: str) -> None:
    with pytest.raises(CameraError, match=r"expected its number, as in device:0"):
        open_source(word)


@pytest.mark.parametrize(
    ("word", "settings", "name"),
    [
        ("synthetic:somewhere", CameraSettings(rate=60.0), "rate"),
        ("synthetic", CameraSettings(gain=3.0), "gain"),
        ("/tmp", CameraSettings(exposure=1e-3), "exposure"),
        ("device:0", CameraSettings(exposure=1e-3), "exposure"),
        ("device:0", CameraSettings(trigger_line=0), "trigger_line"),
    ],
)
def test_a_setting_is_refused_where_the_source_takes_none(word: str, settings: CameraSettings, name: str) -> None:
    with pytest.raises(CameraError, match=f"{name} is .*, but '{word}' takes none; leave it out"):
        open_source(word, settings)


@pytest.mark.parametrize("wrong", [{"rate": 0.0}, {"rate": float("nan")}, {"exposure": 100.0}, {"exposure": -1e-4}])
def test_an_impossible_rate_or_exposure_is_refused(wrong: dict[str, Any]) -> None:
    with pytest.raises(CameraError, match=f"{next(iter(wrong))} is .*; expected"):
        open_source("synthetic", CameraSettings(**wrong))
