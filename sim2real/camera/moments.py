"""What a recording or a simulated game says, as moments to be rendered."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from baselines import Seat, make_player
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


def simulated(variant: str, players: tuple[str, str], seed: int, rate: float) -> Iterator[Moment]:
    """The moments of a game, `rate` a second [Hz], played as they are asked for, until the game ends.

    The first of `players` is the robot. A puck in a goal is not there.
    """
    tables = Tables(variant, 1, seed=seed, autoreset=False)
    seated = [make_player(name, Seat.from_tables(tables, seed=2 * seed + k)) for k, name in enumerate(players)]
    for player in seated:
        player.reset(np.ones(1, np.bool_))
    period, played, given = tables.variant.period, 0.0, 0
    while not (tables.terminated[0] or tables.truncated[0]):
        actions = np.stack([player.act(tables.observations[:, k]) for k, player in enumerate(seated)], axis=1)
        last = math.ceil((played + period) * rate - 1e-6)
        times = np.arange(given, last) / rate
        states, scored = trace(tables, 0, actions[0], np.clip(times - played, 0.0, period))
        for time, state, goal in zip(times, states, scored, strict=True):
            robot, opponent = (Motion(*map(float, mallet)) for mallet in mallet_motion(state))
            puck = None if goal else Motion(*map(float, puck_motion(state)))
            yield Moment(float(time), puck, opponent, robot)
        tables.step(actions)
        played, given = played + period, last
