"""Rendered pictures of a game or of a recording, played back."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace
from pathlib import Path

from sim2real.camera.frame import Frame
from sim2real.camera.moments import recorded, simulated
from sim2real.camera.playback import Playback
from sim2real.camera.render.moment import Moment
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.sensor import Sensor
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View
from sim2real.recording import Recording, read_recording

GAME, PLAYERS = "puckpilot/match-v0", ("interceptor", "follower")


class Synthetic(Playback):
    """A picture of each moment, whole frames, numbered from 0. `moments` may be endless: each is drawn when asked."""

    def __init__(self, renderer: Renderer, moments: Iterable[Moment]) -> None:
        super().__init__(_frames(renderer, moments))


def _frames(renderer: Renderer, moments: Iterable[Moment]) -> Iterator[Frame]:
    for number, moment in enumerate(moments):
        yield Frame(renderer.picture(moment, number), moment.time, moment.time, number)


def scene_of(name: str) -> tuple[Table, View]:
    """The table that synthetic:NAME shows, of the size that the recording NAME states, or the usual one for none; and
    where its camera stands. RecordingError if NAME is no recording."""
    table = _table_of(read_recording(Path(name))) if name else Table.with_markers()
    return table, View.like_the_real_one(table.length, table.width)


def of_a_game(rate: float, exposure: float) -> Synthetic:
    """A match of two scripted players to its end, at `rate` [Hz] and with `exposure` [s]."""
    return Synthetic(_renderer(Table.with_markers(), exposure), simulated(GAME, PLAYERS, 0, rate))


def of_a_recording(path: Path, exposure: float) -> Synthetic:
    """What a recording says, on a table of the size that it states, frame by frame. RecordingError if it is none."""
    recording = read_recording(path)
    return Synthetic(_renderer(_table_of(recording), exposure), recorded(recording))


def _table_of(recording: Recording) -> Table:
    sizes = {"length": ("table", "length_m"), "width": ("table", "width_m")}
    stated = {name: recording.nominal(*where) for name, where in sizes.items()}
    table = Table.with_markers(**{name: size for name, size in stated.items() if size is not None})
    radii = {"puck_radius": ("puck", "radius_m"), "mallet_radius": ("mallet", "radius_m")}
    stated = {name: recording.nominal(*where) for name, where in radii.items()}
    return replace(table, **{name: radius for name, radius in stated.items() if radius is not None})


def _renderer(table: Table, exposure: float) -> Renderer:
    return Renderer(table, View.like_the_real_one(table.length, table.width), Sensor(exposure=exposure))
