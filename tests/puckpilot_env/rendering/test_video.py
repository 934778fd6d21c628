"""Films as files: whole or not at all, with every frame in its time."""

from __future__ import annotations

import numpy as np
import pytest
from PIL import Image

from puckpilot_env.rendering.video import VideoWriter


def make_frames(count: int, shape=(48, 64)) -> list[np.ndarray]:
    """A dark square that moves over a light ground, one pixel a frame."""
    frames = []
    for i in range(count):
        frame = np.full((*shape, 3), (240, 244, 250), np.uint8)
        frame[10:20, i : i + 10] = (30, 60, 200)
        frames.append(frame)
    return frames


def write(path, frames, fps=25.0):
    with VideoWriter(path, fps) as video:
        for frame in frames:
            video.add(frame)
    return video


def read_gif(path) -> tuple[list[np.ndarray], list[int]]:
    """Frames, and durations [ms]."""
    frames, durations = [], []
    with Image.open(path) as image:
        for i in range(getattr(image, "n_frames", 1)):
            image.seek(i)
            frames.append(np.asarray(image.convert("RGB")))
            durations.append(image.info["duration"])
    return frames, durations


@pytest.mark.parametrize(("fps", "total"), [(25, 1000), (20, 1250), (30, 830)])
def test_gif_keeps_frames_colours_and_time(tmp_path, fps, total):
    frames = make_frames(25)
    assert write(tmp_path / "a.gif", frames, fps).frames == 25
    found, durations = read_gif(tmp_path / "a.gif")
    assert sum(durations) == total and max(durations) - min(durations) <= 10
    np.testing.assert_array_equal(found, frames)


def test_gif_holds_repeated_frames(tmp_path):
    frames = make_frames(3)
    write(tmp_path / "a.gif", [frames[0]] * 5 + frames[1:2] + [frames[2]] * 4)
    assert sum(read_gif(tmp_path / "a.gif")[1]) == 400


def test_gif_of_one_frame(tmp_path):
    write(tmp_path / "a.gif", make_frames(1))
    np.testing.assert_array_equal(read_gif(tmp_path / "a.gif")[0], make_frames(1))


def test_gif_of_many_colours_stays_close(tmp_path):
    ramp = np.linspace(0, 255, 64)
    frame = np.stack(np.broadcast_arrays(ramp[None, :], ramp[:48, None], 128.0), axis=2).astype(np.uint8)
    write(tmp_path / "a.gif", [frame, frame[:, ::-1].copy()])
    found, _ = read_gif(tmp_path / "a.gif")
    assert np.abs(found[0].astype(int) - frame).max() < 24
    assert np.abs(found[1].astype(int) - frame[:, ::-1]).max() < 24


def test_mp4_keeps_frames_and_rate(tmp_path):
    cv2 = pytest.importorskip("cv2")
    frames = make_frames(12, (96, 128))
    write(tmp_path / "a.mp4", frames, 30.0)
    film = cv2.VideoCapture(str(tmp_path / "a.mp4"))
    assert film.get(cv2.CAP_PROP_FPS) == pytest.approx(30.0)
    found = []
    while (read := film.read())[0]:
        found.append(read[1][..., ::-1])
    assert len(found) == 12
    assert np.abs(np.array(found, int) - frames).mean() < 6
    assert [p.name for p in tmp_path.iterdir()] == ["a.mp4"]


@pytest.mark.parametrize("ending", ["gif", "mp4"])
def test_failing_writer_leaves_what_was_there(tmp_path, ending):
    path = tmp_path / f"a.{ending}"
    for before in (None, b"old"):
        if before:
            path.write_bytes(before)
        with pytest.raises(RuntimeError), VideoWriter(path, 25.0) as video:
            video.add(make_frames(1)[0])
            raise RuntimeError
        with pytest.raises(ValueError, match="no frames"), VideoWriter(path, 25.0):
            pass
        assert [p.read_bytes() for p in tmp_path.iterdir()] == ([before] if before else [])


@pytest.mark.parametrize(
    ("name", "fps", "words"),
    [
        ("a.avi", 25, r"\.gif or \.mp4"),
        ("a", 25, r"\.gif or \.mp4"),
        ("none/a.gif", 25, "folder does not exist"),
        ("a.gif", 60, "from 1 to 50"),
        ("a.mp4", 0, "from 1 to 240"),
        ("a.gif", float("nan"), "from 1 to 50"),
    ],
)
def test_mistakes_are_named_in_one_line(tmp_path, name, fps, words):
    with pytest.raises(ValueError, match=words) as caught:
        VideoWriter(tmp_path / name, fps)
    assert "\n" not in str(caught.value)
    assert not list(tmp_path.iterdir())


def test_wrong_frames_are_refused(tmp_path):
    frame = make_frames(1)[0]
    for wrong in (frame.astype(float), frame[..., 0], frame[:-2]):
        with pytest.raises(ValueError, match="expected"), VideoWriter(tmp_path / "a.gif", 25.0) as video:
            video.add(frame)
            video.add(wrong)
    with pytest.raises(ValueError, match="even"):
        write(tmp_path / "a.mp4", [frame[:-1]])
    assert not list(tmp_path.iterdir())
