"""The renderer: the picture that a camera would take of the table in a given state."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sim2real.camera.render.background import Background
from sim2real.camera.render.bodies import BodyShapes, draw
from sim2real.camera.render.box import Box
from sim2real.camera.render.paint import Shape, paint
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.render.sensor import PixelNoise, Sensor
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView

PER_PIXEL = 4  # instants per pixel of motion during the exposure
EMPTIES = 8  # pictures of the empty table, used in turn where nothing moves, so that their noise repeats


class Renderer:
    """Renders pictures of a table in a view. The same seed, state and number always give the same picture.

    >>> renderer = Renderer(table, CameraView.like_the_real_one(table.length, table.width))
    >>> image = renderer.picture(SceneState(puck=BodyState(0.7, 0.4, vx=3.0)), number=17)

    Outlines are projected with OpenCV and cover pixels by exact area: the puck's edge is exact to about 1e-3 pixels,
    which is 2 micrometres on the table. Only the parts in which something moves are drawn anew.
    """

    def __init__(self, table: Table, view: CameraView, sensor: Sensor | None = None, seed: int = 0) -> None:
        self.table, self.view = table, view
        self.sensor = sensor or Sensor()
        self._still = Background(table, view)
        self.box = self._still.box
        self._noise = PixelNoise(self.box, seed)
        self._blurred = self.sensor.spread(self._still.light)
        self._empties: dict[int, np.ndarray] = {}

    def picture(self, state: SceneState, number: int = 0, box: Box | None = None) -> np.ndarray:
        """Render a picture uint8 (rows, columns) of `box`, or of the whole frame if None; `number` selects its
        noise."""
        box = self.box if box is None else box.common(self.box)
        image = self._empty(number % EMPTIES)[box.within(self.box)].copy()
        noise, instants = self._noise.of(number, box), self._instants(state)
        for part in self._changed(instants, box):
            within = part.within(box)
            image[within] = self.sensor.levels(self._light(instants, part), noise[within])
        return image

    def light(self, state: SceneState, box: Box | None = None) -> np.ndarray:
        """The picture before noise, rounding and saturation: grey levels float64 (rows, columns)."""
        box = self.box if box is None else box.common(self.box)
        light = self._blurred[box.within(self.box)].astype(float)
        instants = self._instants(state)
        for part in self._changed(instants, box):
            light[part.within(box)] = self._light(instants, part)
        return light

    def box_of(self, state: SceneState, margin: int = 20) -> Box:
        """The box of the puck with a margin [pixels]. Raises ValueError for a state without a puck."""
        if state.puck is None:
            raise ValueError("the state has no puck; give one that has, or take the whole frame")
        (puck,) = draw(SceneState(puck=state.puck), self.table, self.view).low
        return Box.around(puck.outline).wider(margin).common(self.box)

    def _empty(self, kind: int) -> np.ndarray:
        """The empty table with noise, uint8."""
        if kind not in self._empties:
            self._empties[kind] = self.sensor.levels(self._blurred, self._noise.of(kind, self.box))
        return self._empties[kind]

    def _instants(self, state: SceneState) -> list[BodyShapes]:
        """The bodies at evenly spread instants of the exposure, more of them for faster motion."""
        speed = max((math.hypot(body.vx, body.vy) for body in state.bodies), default=0.0)
        pixels = speed * self.sensor.exposure * self.view.matrix[0, 0] / self.view.place[2]  # at most, nearly
        count = max(math.ceil(PER_PIXEL * pixels), 1)
        times = ((np.arange(count) + 0.5) / count - 0.5) * self.sensor.exposure
        return [draw(_later(state, float(time)), self.table, self.view) for time in times]

    def _changed(self, instants: list[BodyShapes], box: Box) -> list[Box]:
        """The parts of `box` in which something moves; near ones are joined if that saves pixels."""
        parts: list[Box] = []
        for same in zip(*([*drawn.low, *drawn.high] for drawn in instants), strict=True):
            around = Box.around(np.concatenate([shape.outline for shape in same]))
            part = around.wider(self.sensor.reach).common(box)
            while near := next((p for p in parts if p.joined(part).pixels <= p.pixels + part.pixels), None):
                parts.remove(near)
                part = part.joined(near)
            parts.append(part)
        return [part for part in parts if not part.empty]

    def _light(self, instants: list[BodyShapes], box: Box) -> np.ndarray:
        """Blurred light float64 (rows, columns) in `box`, averaged over the exposure."""
        wide = box.wider(self.sensor.reach).common(self.box)
        light = self._sharp(instants[0], wide)
        for drawn in instants[1:]:
            light += self._sharp(drawn, wide)
        light /= len(instants)
        return self.sensor.spread(light)[box.within(wide)]

    def _sharp(self, drawn: BodyShapes, box: Box) -> np.ndarray:
        """Light float64 (rows, columns) in `box` at one instant, without blur."""
        still = self._still.light[box.within(self.box)]
        light = still.astype(float)
        _paint_all(light, box, drawn.low)
        if self._still.hiding is not None:
            light += self._still.hiding[box.within(self.box)] * (still - light)
        _paint_all(light, box, drawn.high)
        return light


def _paint_all(light: np.ndarray, box: Box, shapes: list[Shape]) -> None:
    for shape in shapes:
        paint(light, box, shape)


def _later(state: SceneState, time: float) -> SceneState:
    bodies = {name: getattr(state, name) for name in ("puck", "opponent", "mallet")}
    return replace(state, **{name: body.after(time) for name, body in bodies.items() if body})
