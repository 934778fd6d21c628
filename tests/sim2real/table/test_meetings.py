"""Games of the twin that are kept and resumed, and their figures by hand."""

from __future__ import annotations

from pathlib import Path

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.recording.folder import read_recording
from sim2real.table import meetings
from sim2real.table.meetings import Meeting, PlayedMeeting, play_all
from sim2real.table.recorder.draft import draft_of

MEETINGS = [Meeting("still", "goalie", "puckpilot/match-v0", seed) for seed in (3, 4, 5)]


def result(meeting: Meeting, recording: Path | None = None) -> PlayedMeeting:
    return PlayedMeeting(1, (meeting.seed, 0), 60.0, 62.0, 20.0, 25.0)


def test_a_stopped_run_goes_on_where_it_was(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    played: list[int] = []

    def fails_at_the_second(meeting: Meeting, recording: Path | None) -> PlayedMeeting:
        if meeting.seed == 4 and len(played) == 1:
            raise KeyboardInterrupt
        played.append(meeting.seed)
        return result(meeting)

    monkeypatch.setattr(meetings, "play_meeting", fails_at_the_second)
    with pytest.raises(KeyboardInterrupt):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)
    played.append(-1)
    counts: list[tuple[int, int]] = []
    games = play_all(MEETINGS, tmp_path, 1, lambda done, count: counts.append((done, count)))
    assert played == [3, -1, 4, 5] and counts == [(2, 3), (3, 3)]
    assert games == [result(one) for one in MEETINGS]


@pytest.mark.parametrize("text", ["{", "[]", f'{{"format": "{meetings.FORMAT}", "meeting": {{}}, "game": {{}}}}'])
def test_a_file_of_another_meeting_is_refused(text: str, tmp_path: Path) -> None:
    (tmp_path / "game_3.json").write_text(text)
    with pytest.raises(ValueError, match=r"game_3.json: is no result of this meeting; name another folder"):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)


def test_a_game_of_another_version_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(meetings, "play_meeting", result)
    monkeypatch.setattr(meetings, "code_version", lambda *_: "before")
    play_all(MEETINGS, tmp_path, 1, lambda done, count: None)
    monkeypatch.setattr(meetings, "code_version", lambda *_: "after")
    with pytest.raises(ValueError, match=r"game_3.json: was played by another version of the code; name another"):
        play_all(MEETINGS, tmp_path, 1, lambda done, count: None)


def test_a_game_is_recorded_anew_where_a_killed_run_left_half_of_it(tmp_path: Path) -> None:
    half = draft_of(tmp_path / "recordings" / "game_3")
    half.mkdir(parents=True)
    (half / "meta.json").write_text("{}")
    (half / "frames.csv").write_text("t,puck_x,puck_y\n0.0,1.0,0.5\n")
    game = Meeting("still", "goalie", "puckpilot/match-v0", 3, 2.5, clears=True, recorded=True)
    play_all([game], tmp_path, 1, lambda done, count: None)
    recording = read_recording(tmp_path / "recordings" / "game_3")
    assert recording.frames is not None and recording.frames.rows > 100 and not half.exists()


def test_games_of_a_policy_are_kept_where_it_moves_and_refused_where_it_changed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(meetings, "play_meeting", result)
    runs = [tmp_path / name for name in ("one", "other")]
    (tmp_path / "games").mkdir()
    for run in runs:
        run.mkdir()
        (run / "policy.npz").write_bytes(b"weights")
    one, moved = (Meeting(f"policy:{run}", "goalie", "puckpilot/match-v0", 3) for run in runs)
    games = play_all([one], tmp_path / "games", 1, lambda done, count: None)
    assert play_all([moved], tmp_path / "games", 1, lambda done, count: None) == games
    (runs[1] / "policy.npz").write_bytes(b"others")
    with pytest.raises(ValueError, match=r"game_3.json: was played by another player than policy:.*other;"):
        play_all([moved], tmp_path / "games", 1, lambda done, count: None)
