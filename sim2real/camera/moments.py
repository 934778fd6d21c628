"""What a recording or a simulated game says, as moments to be rendered."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.motion import mallet_motion, puck_motion
from puckpilot_env.tables import Tables
from puckpilot_env.trace import trace
from sim2real.camera.render.moment import Moment, Motion
from sim2real.recording import Recording
from sim2real.recording_csv import Stream


def recorded(recording: Recording) -> Iterator[Moment]:
    """A moment for each frame of a recording, at its time; what was not seen is not there.

    Velocities are those from the frame before to the one after. The robot's own mallet, which its encoders tell, is put
    in between their stamps, and is not there before their first and after their last.
    """
    frames = recording.frames
    if frames is None:
        raise ValueError(
            f"recording {recording.name} has no frames.csv; expected positions of the puck, so choose another"
        )
    puck, opponent = (_track(frames, name, frames.t) for name in ("puck", "opponent"))
    mallet = _track(recording.mallet, "mallet", frames.t) if recording.mallet else [None] * len(puck)
    for row in zip(frames.t, puck, opponent, mallet, strict=True):
        yield Moment(float(row[0]), *row[1:])


def _track(stream: Stream, name: str, times: NDArray[np.float64]) -> list[Motion | None]:
    """Where something was at `times` (n,), blank cells left out, so far as the stream reaches."""
    places = np.stack([stream.columns[f"{name}_{axis}"] for axis in "xy"])
    speeds = np.gradient(places, stream.t, axis=1) if len(stream.t) > 1 else np.zeros_like(places)
    columns = np.concatenate([places, np.nan_to_num(speeds)])
    if stream.t is not times:
        columns = np.stack([np.interp(times, stream.t, column, np.nan, np.nan) for column in columns])
    return [None if np.isnan(column[:2]).any() else Motion(*map(float, column)) for column in columns.T]


class Watched:
    """Collects the moments of a game while it is played: what `baselines.match.play` calls `watch`.

    >>> watched = Watched(rate=120.0, longest=10.0)
    >>> play("puckpilot/match-v0", "veteran", "goalie", games=1, seed=0, watch=watched)
    >>> source = Synthetic(renderer, watched.moments)
    """

    def __init__(self, rate: float, longest: float) -> None:
        """rate: moments a second of play [Hz]; longest: of play [s]."""
        self.moments: list[Moment] = []
        self._rate, self._longest = rate, longest
        self._played = 0.0
        self._over = False

    def __call__(self, tables: Tables, actions: NDArray[np.float32]) -> None:
        """Add the moments of the step that is about to be played on table 0."""
        ended = bool(tables.terminated[0] or tables.truncated[0])
        self._over = self._over or ended or self._played > self._longest - 1e-9
        if self._over:
            return
        period = tables.variant.period
        first, last = (np.ceil(time * self._rate - 1e-6) for time in (self._played, self._played + period))
        times = np.clip(np.arange(first, last) / self._rate - self._played, 0.0, period)
        for time, state in zip(times, trace(tables, 0, actions[0], times)[0], strict=True):
            robot, opponent = (Motion(*map(float, mallet)) for mallet in mallet_motion(state))
            self.moments.append(Moment(self._played + time, Motion(*map(float, puck_motion(state))), opponent, robot))
        self._played += period
