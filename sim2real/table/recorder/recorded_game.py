"""What happens at a seat of a table, in a recording."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from sim2real.recording.table_parameters import recording_meta
from sim2real.table.game.robot_seat import RobotSeat
from sim2real.table.recorder.draft import RecordingDraft
from sim2real.table.recorder.recorded_table import DRIVE_NOTE, RecordedTable


@contextmanager
def recorded(env: RobotSeat, folder: Path, note: str) -> Iterator[RecordingDraft]:
    """Inside, all that passes at the seat's backend is recorded as the new `folder`, which is there afterwards,
    whatever ended it; yields the draft. The seat has to be connected anew inside, by a reset with a seed.

    RecordingError, in one line, and before anything moves, for a folder that exists or cannot be written.
    """
    draft = RecordingDraft(folder, recording_meta(env.game.p, env.backend.frame_rate, f"{note}; {DRIVE_NOTE}"))
    table = env.backend
    env.backend = RecordedTable(table, draft, env.game.p)
    try:
        yield draft
    finally:
        try:
            env.close()
        finally:
            env.backend = table
            draft.finish()
