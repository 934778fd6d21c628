"""Films of a recording: what a part may be, and that a film shows the puck where the recording has it."""

from __future__ import annotations

import asyncio
from pathlib import Path
from typing import Any

import numpy as np
import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")
import cv2  # noqa: E402
from aiohttp.test_utils import TestClient, TestServer  # noqa: E402

from sim2real.arena.lobby import Lobby  # noqa: E402
from sim2real.arena.recordings.film import place_at  # noqa: E402
from sim2real.arena.recordings.film_maker import Part  # noqa: E402
from sim2real.arena.recordings.records import Records  # noqa: E402
from sim2real.arena.server import make_app  # noqa: E402
from sim2real.recording.folder import Recording, Stream, write_recording  # noqa: E402

RATE = 120.0
META = {
    "format": "puckpilot-recording/1", "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": 0.32},
    "puck": {"radius_m": 0.03}, "mallet": {"radius_m": 0.05}, "camera": {"rate_hz": RATE, "position_std_m": 2e-4},
    "note": "by hand",
}  # fmt: skip


def written(folder: Path) -> Path:
    """A recording of two seconds, in which the puck goes along the table at 0.6 m/s from x 0.3 and y 0.7 m."""
    t = np.arange(0.0, 2.0, 1.0 / RATE)
    y, far = np.full(len(t), 0.7), np.full(len(t), 1.8)
    columns: dict[str, np.ndarray] = {"t": t, "puck_x": 0.3 + 0.6 * t, "puck_y": y, "opponent_x": far, "opponent_y": y}
    write_recording(folder, Recording(folder.name, META, frames=Stream(columns)))
    return folder


def puck_in(picture: np.ndarray) -> tuple[float, float]:
    """Where the puck is [m] in a picture (h, w, 3), BGR, of a table of 2 x 1 m: its dark pixels, inside the rails.

    A table has 40 / 280 m beside it and 56 / 280 m above it, at as many pixels a metre as the picture's width says."""
    scale = picture.shape[1] / (2.0 + 80 / 280)
    rows, columns = np.nonzero(picture.astype(int).sum(axis=2) < 3 * 60)
    x, y = (columns + 0.5) / scale - 40 / 280, 1.0 - ((rows + 0.5) / scale - 56 / 280)
    inside = (abs(x - 1.0) < 0.97) & (abs(y - 0.5) < 0.47)
    return float(x[inside].mean()), float(y[inside].mean())


@pytest.mark.parametrize(("begin", "end", "words"), [
    ("", "1", "expected two numbers of seconds"), ("a", "1", "'a' to '1'"), ("nan", "1", "from nan to 1 s"),
    ("0", "inf", "to inf s"), ("2", "1", "from 2 to 1 s"), ("-1", "1", "from -1"), ("0", "31", "30 s between them at"),
])  # fmt: skip
def test_a_part_that_is_none_or_too_long_is_refused_in_one_line(begin: str, end: str, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        Part.parse(begin, end)
    assert "\n" not in str(error.value)


def test_places_between_rows_and_none_over_a_gap() -> None:
    track: dict[str, Any] = {"t": [0.0, 0.1, 0.5, 0.6], "place": [[0.2, 0.4], [0.3, 0.4], [1.0, 0.5], None]}
    assert place_at(track, 0.05) == pytest.approx((0.25, 0.4)) and place_at(track, -0.1) is None
    assert place_at(track, 0.15) == (0.3, 0.4) and place_at(track, 0.3) is None
    assert place_at(track, 0.55) == (1.0, 0.5) and place_at(track, 0.65) is None


@pytest.mark.slow
def test_a_film_is_for_those_who_know_the_token_and_shows_the_puck_where_it_was(tmp_path: Path) -> None:
    folder = written(tmp_path / "slide")

    async def run() -> bytes:
        records = Records(tmp_path / "out", [folder])
        async with TestClient(
            TestServer(make_app(Lobby(("still", "still"), 0, records), records, "a-token"))
        ) as client:
            given = {"name": "slide", "from": "0.5", "to": "1.0", "token": "a-token"}
            assert (await client.get("/film", params=given | {"token": "b"})).status == 403
            assert (await client.get("/film", params=given | {"name": "../slide"})).status == 404
            long = await client.get("/film", params=given | {"to": "99"})
            assert long.status == 400 and "between them at most" in await long.text()
            late = await client.get("/film", params=given | {"from": "9", "to": "10"})
            assert late.status == 422 and (await late.text()).startswith("from 9 s; the recording ends at 1.99")
            film = await client.get("/film", params=given)
            assert film.status == 200 and film.content_type == "video/mp4"
            return await film.read()

    (tmp_path / "film.mp4").write_bytes(asyncio.run(run()))
    video = cv2.VideoCapture(str(tmp_path / "film.mp4"))
    assert video.get(cv2.CAP_PROP_FRAME_COUNT) == 16 and video.get(cv2.CAP_PROP_FPS) == pytest.approx(30.0)
    pictures = [video.read()[1] for _ in range(16)]
    video.release()
    for number in (0, 15):
        expected = (0.3 + 0.6 * (0.5 + number / 30.0), 0.7)
        assert puck_in(pictures[number]) == pytest.approx(expected, abs=0.006)
