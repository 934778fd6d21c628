"""Pictures of a twin's game: when they are taken, of what, and that a film shows the game that was played."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from PIL import Image

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.gap import film as film_module
from sim2real.gap.film import TwinFilm, film
from sim2real.table.game.game_record import GameRecord
from sim2real.table.meetings import Meeting, Onlooker, play_meeting

MEETING = Meeting("interceptor", "goalie", "match-v0", 5, 2.0, concealed="late", clears=True)


class Pictures:
    """Keeps what it is given."""

    fps = 30.0

    def __init__(self) -> None:
        self.pictures: list[NDArray[np.uint8]] = []

    def add(self, frame: NDArray[np.uint8]) -> None:
        self.pictures.append(frame)


def seen(see: Onlooker, record: np.void, time: float, x: float) -> None:
    plant: Any = SimpleNamespace(
        time=time, puck=np.array([x, 0.5, 0.0, 0.0]), mallet=lambda which: (0.2 + 1.6 * which, 0.5, 0.0, 0.0),
        acceleration=lambda which: (0.0, 0.0),
    )  # fmt: skip
    see(plant, record)


def test_pictures_are_due_from_the_face_off_on_and_the_puck_stays_in_a_goal() -> None:
    record, video = GameRecord("match-v0").record, Pictures()
    made = TwinFilm(MEETING, "before", video)
    for k in range(12):
        seen(made.see, record, k / 120.0, float("nan"))
    assert not video.pictures
    for k in range(12, 72):  # half a second
        seen(made.see, record, k / 120.0, 1.0 - (k - 12) / 60.0)
    assert len(video.pictures) == 15 and (video.pictures[0] != video.pictures[-1]).any()
    seen(made.see, record, 72 / 120.0, float("nan"))
    assert len(video.pictures) == 16
    header, table = video.pictures[-1][:30], video.pictures[-1][30:]
    assert (header != video.pictures[-2][:30]).any() and (table != video.pictures[0][30:]).any()


def test_a_game_that_was_recorded_is_filmed_as_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A recording takes a while before the first face-off. None is left by a film."""
    played: list[tuple[float | None, Path | None]] = []

    def plays(meeting: Meeting, recording: Path | None, see: Onlooker) -> None:
        played.append((meeting.seconds, recording))
        seen(see, GameRecord("match-v0").record, 1.0, 1.0)

    monkeypatch.setattr(film_module, "play_meeting", plays)
    for recorded in (False, True):
        film(replace(MEETING, seconds=60.0, recorded=recorded), tmp_path / "film.gif", "before")
    (first, none), (second, folder) = played
    assert first == second == 10.0 and none is None and folder is not None and not folder.parent.exists()
    assert [one.name for one in tmp_path.iterdir()] == ["film.gif"]


@pytest.mark.long
def test_a_film_is_the_beginning_of_the_game_at_its_own_speed(tmp_path: Path) -> None:
    """A longer game goes as a shorter one, a recorded one has the same face-off; 2 s of play are 2 s of film."""
    games = []
    for seconds, recording in ((2.0, None), (1.0, None), (0.3, tmp_path / "recording")):
        path: list[tuple[float, ...]] = []
        play_meeting(
            replace(MEETING, seconds=seconds), recording,
            lambda plant, record, path=path: path.append((plant.time, *plant.puck, *plant.mallet(0))),
        )  # fmt: skip
        games.append(np.array(path))
    longer, shorter, _ = games
    assert np.allclose(longer[: len(shorter)], shorter, rtol=0.0, atol=1e-9, equal_nan=True) and len(shorter) > 100
    put_down = [one[np.isfinite(one[:, 1])][0] for one in games]
    assert np.allclose(put_down[0][3:5], put_down[2][3:5], rtol=0.0, atol=0.01)
    film(MEETING, tmp_path / "film.gif", "before")
    with Image.open(tmp_path / "film.gif") as made:
        shown = []
        for frame in range(getattr(made, "n_frames", 1)):
            made.seek(frame)
            shown.append(made.info["duration"])
    assert 2000 <= sum(shown) < 2600 and sum(shown) / len(shown) < 40
