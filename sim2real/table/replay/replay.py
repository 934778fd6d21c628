"""The replay of a recording as a backend: a policy sees what was recorded, while the mallet goes where it went."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.recording.table_parameters import stated_sizes
from sim2real.table.backend import Backend, Motion, Place, Reading, SeenFrame, SeenMallet
from sim2real.table.game.game_record import GameRecord
from sim2real.table.mallet_driver import MalletPlan

LIKE = 1e-3  # m within which the recording's sizes are the game's
SPAN = 0.02  # s of the encoders' places from which the mallet's velocity is taken


class Replay(Backend):
    """A recording in lock-step with the player; see `Backend`. Its time is the recording's, and it ends with it.

    Where the mallet's place is blank, it goes straight from the place before to the one after. ValueError, in one line,
    for a recording without frames or mallet, and for one of a table of another size.
    """

    obeys = False
    patience = float("inf")

    def __init__(self, game: GameRecord, recording: Path | str) -> None:
        found = read_recording(recording)
        self._frames, self._mallet = _streams(found)
        _refuse_other_sizes(found, game)
        self.frame_rate = 1.0 / float(np.median(np.diff(self._frames.t))) if self._frames.rows > 1 else np.inf
        self._now, self._taken = -np.inf, 0

    def seed(self, seed: int) -> None:
        """Nothing is drawn."""

    def connect(self, home: Place) -> None:
        """Begin at the recording's first frame."""
        self._now, self._taken = float(self._frames.t[0]), 0

    def clear(self, home: Place) -> None:
        """Nothing stops it."""

    def now(self) -> float:
        """The recording's time [s]."""
        return self._now

    def wait(self, until: float) -> None:
        """Go on to `until` [s]."""
        self._now = max(self._now, until)

    def wait_for_frame(self, until: float) -> None:
        """Go on to the next frame, but no farther than `until` [s]."""
        after = self._frames.t[self._frames.t > self._now]
        self.wait(min(float(after[0]), until) if len(after) else until)

    def read(self) -> Reading:
        """The frames that were passed since the last call, and the mallet's newest place."""
        end = int(np.searchsorted(self._frames.t, self._now, side="right"))
        frames = [self._frame(row) for row in range(self._taken, end)]
        self._taken = end
        late = self._now - frames[-1].time if frames else float("nan")
        mallet = SeenMallet(self._now, self.place(), None, (0.0, 0.0))
        return Reading(frames, [mallet], late, over=end == self._frames.rows)

    def _frame(self, row: int) -> SeenFrame:
        puck, opponent = (self._place(row, name) for name in ("puck", "opponent"))
        return SeenFrame(float(self._frames.t[row]), puck, opponent)

    def _place(self, row: int, name: str) -> Place | None:
        x, y = float(self._frames[f"{name}_x"][row]), float(self._frames[f"{name}_y"][row])
        return (x, y) if np.isfinite([x, y]).all() else None

    def place(self) -> Place:
        """Where the mallet was at this time [m]."""
        x, y, *_ = self.mallet_motion(self._now)
        return x, y

    def mallet_motion(self, time: float) -> Motion:
        """The recorded mallet at `time` [s], with its mean velocity about then."""
        times = np.array([time - 0.5 * SPAN, time, time + 0.5 * SPAN])
        x, y = (np.interp(times, self._mallet.t, self._mallet[name]) for name in ("mallet_x", "mallet_y"))
        return float(x[1]), float(y[1]), float(x[2] - x[0]) / SPAN, float(y[2] - y[0]) / SPAN

    def send(self, plan: MalletPlan) -> MalletPlan:
        """The plan goes nowhere."""
        return plan

    def stop(self) -> None:
        """Nothing moves."""

    def place_puck(self, puck: np.ndarray) -> None:
        """The puck is where it was."""

    def show(self, game: np.void) -> None:
        """Nobody looks."""

    def close(self) -> None:
        """Nothing is held open."""


def _streams(recording: Recording) -> tuple[Stream, Stream]:
    """Frames, and the mallet where its place is known; neither empty. ValueError, in one line, where one is missing."""
    frames, mallet = recording.frames, recording.mallet
    if mallet is not None:
        known = np.isfinite(mallet["mallet_x"]) & np.isfinite(mallet["mallet_y"])
        mallet = Stream({name: mallet[name][known] for name in ("t", "mallet_x", "mallet_y")})
    for name, stream, what in (("frames", frames, "rows"), ("mallet", mallet, "places")):
        if stream is None or not stream.rows:
            raise ValueError(
                f"recording {recording.name} has no {what} in {name}.csv; a replay needs frames and mallet"
            )
    assert frames is not None and mallet is not None
    return frames, mallet


def _refuse_other_sizes(recording: Recording, game: GameRecord) -> None:
    stated = stated_sizes(recording)
    for name, size in stated.items():
        if abs(size - float(game.p[name])) > LIKE:
            raise ValueError(
                f"recording {recording.name} states {name} {size:g}, the game {float(game.p[name]):g}; "
                f"give parameters={stated}"
            )
