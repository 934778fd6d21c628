"""The scene states of a recording or of a simulated game, to be rendered."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from baselines import Seat, make_player
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.batch.trace import trace
from puckpilot_env.tables import Tables
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.recording.folder import Recording
from sim2real.recording.stream_csv import Stream


def recorded_states(recording: Recording) -> Iterator[SceneState]:
    """A state for each frame of a recording, at its time, without the objects that the frame does not have.

    Velocities are central differences over the neighbouring frames. The place of the robot's own mallet is interpolated
    between its encoder samples; before the first and after the last it is missing. Raises ValueError for a recording
    without frames.
    """
    frames = recording.frames
    if frames is None:
        raise ValueError(
            f"recording {recording.name} has no frames.csv; expected positions of the puck, so choose another"
        )
    puck, opponent = (_track(frames, name, frames.t) for name in ("puck", "opponent"))
    mallet = _track(recording.mallet, "mallet", frames.t) if recording.mallet else [None] * len(puck)
    for row in zip(frames.t, puck, opponent, mallet, strict=True):
        yield SceneState(float(row[0]), *row[1:])


def _track(stream: Stream, name: str, times: NDArray[np.float64]) -> list[BodyState | None]:
    """The states of an object at `times` (n,) [s]; None for blank cells and outside of the stream."""
    places = np.stack([stream.columns[f"{name}_{axis}"] for axis in "xy"])
    speeds = np.gradient(places, stream.t, axis=1) if len(stream.t) > 1 else np.zeros_like(places)
    columns = np.concatenate([places, np.nan_to_num(speeds)])
    if stream.t is not times:
        columns = np.stack([np.interp(times, stream.t, column, np.nan, np.nan) for column in columns])
    return [None if np.isnan(column[:2]).any() else BodyState(*map(float, column)) for column in columns.T]


def simulated_states(variant: str, players: tuple[str, str], seed: int, rate: float) -> Iterator[SceneState]:
    """The states of a game at a rate [Hz], until the game ends; the game is played lazily, as states are taken.

    variant: of the environment; players: names of robot and opponent; seed: of the game. A puck in a goal is missing.
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
            robot, opponent = (BodyState(*map(float, mallet)) for mallet in mallet_motion(state))
            puck = None if goal else BodyState(*map(float, puck_motion(state)))
            yield SceneState(float(time), puck, opponent, robot)
        tables.step(actions)
        played, given = played + period, last
