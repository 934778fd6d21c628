"""Games of the twin that are kept and resumed, and their figures by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.table.twin import fidelity
from sim2real.table.twin.fidelity import Meeting, TwinGame, goals_a_minute, play_all

MEETINGS = [Meeting("still", "goalie", "puckpilot/match-v0", seed) for seed in (3, 4, 5)]


def result(meeting: Meeting, recording: Path | None = None) -> TwinGame:
    return TwinGame(1, (meeting.seed, 0), 60.0, 62.0, 20.0, 25.0)


def test_a_stopped_run_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    played: list[int] = []

    def fails_at_the_second(meeting: Meeting, recording: Path | None) -> TwinGame:
        if meeting.seed == 4 and len(played) == 1:
            raise KeyboardInterrupt
        played.append(meeting.seed)
        return result(meeting)

    monkeypatch.setattr(fidelity, "play_on_twin", fails_at_the_second)
    with pytest.raises(KeyboardInterrupt):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)
    played.append(-1)
    counts: list[tuple[int, int]] = []
    games = play_all(MEETINGS, tmp_path, 1, lambda done, count: counts.append((done, count)))
    assert played == [3, -1, 4, 5] and counts == [(2, 3), (3, 3)]
    assert games == [result(one) for one in MEETINGS]


@pytest.mark.parametrize("text", ["{", "[]", '{"format": "puckpilot-twin-game/1", "meeting": {}, "game": {}}'])
def test_a_file_of_another_meeting_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "game_3.json").write_text(text)
    with pytest.raises(ValueError, match=r"game_3.json: is no result of this meeting; name another folder"):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)


def test_a_game_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(fidelity, "play_on_twin", result)
    monkeypatch.setattr(fidelity, "code_version", lambda *_: "before")
    play_all(MEETINGS, tmp_path, 1, lambda done, count: None)
    monkeypatch.setattr(fidelity, "code_version", lambda *_: "after")
    with pytest.raises(ValueError, match=r"game_3.json: was played by another version of the code; name another"):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)


def test_goals_a_minute_are_all_goals_by_all_minutes() -> None:
    games = [TwinGame(1, (7, 1), 30.0, 31.0, 9.0, 9.0), TwinGame(1, (5, 0), 90.0, 91.0, 9.0, 9.0)]
    rate, low, high = goals_a_minute(games, 0)
    assert rate == pytest.approx(6.0)  # 12 in two minutes
    assert (low, high) == pytest.approx((5.0 / 1.5, 14.0))  # both the long game, both the short one
    assert goals_a_minute(games, 1)[0] == pytest.approx(0.5)
