"""Rendered pictures of a game or of a recording as a played-back source."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

from sim2real.camera.frame import Frame
from sim2real.camera.playback import Playback
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.render.sensor import Sensor
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.scene_states import recorded_states, simulated_states
from sim2real.recording.folder import Recording, read_recording

GAME, PLAYERS = "puckpilot/match-v0", ("interceptor", "follower")


class Synthetic(Playback):
    """A picture of each state, numbered from 0. `states` may be endless, because pictures are rendered lazily."""

    def __init__(self, renderer: Renderer, states: Iterable[SceneState]) -> None:
        super().__init__(_frames(renderer, states))


def _frames(renderer: Renderer, states: Iterable[SceneState]) -> Iterator[Frame]:
    for number, state in enumerate(states):
        yield Frame(renderer.picture(state, number), state.time, state.time, number)


def table_and_view(name: str) -> tuple[Table, CameraView]:
    """The table that synthetic:NAME renders, of the size that the recording NAME states, or the default one for an
    empty name; and the camera's view of it. Raises RecordingError if NAME is no recording."""
    table = _table_of(read_recording(Path(name))) if name else Table.with_markers()
    return table, CameraView.like_the_real_one(table.length, table.width)


def of_a_game(rate: float, exposure: float) -> Synthetic:
    """A match of two scripted players to its end, at a rate [Hz] and with an exposure [s]."""
    return Synthetic(_renderer(Table.with_markers(), exposure), simulated_states(GAME, PLAYERS, 0, rate))


def of_a_recording(path: Path, exposure: float) -> Synthetic:
    """The frames of a recording, on a table of the size that it states, with an exposure [s]. Raises RecordingError for
    a bad recording."""
    recording = read_recording(path)
    return Synthetic(_renderer(_table_of(recording), exposure), recorded_states(recording))


def _table_of(recording: Recording) -> Table:
    sizes = _stated(recording, length=("table", "length_m"), width=("table", "width_m"))
    radii = _stated(recording, puck_radius=("puck", "radius_m"), mallet_radius=("mallet", "radius_m"))
    return replace(Table.with_markers(**sizes), **radii)


def _stated(recording: Recording, **where: tuple[str, str]) -> dict[str, Any]:
    """Those of the fields that the recording states."""
    stated = {name: recording.nominal(*one) for name, one in where.items()}
    return {name: value for name, value in stated.items() if value is not None}


def _renderer(table: Table, exposure: float) -> Renderer:
    return Renderer(table, CameraView.like_the_real_one(table.length, table.width), Sensor(exposure=exposure))
