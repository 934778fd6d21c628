"""A renderer: the picture that a camera would take of the table at a moment."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

from sim2real.camera.render.background import Background
from sim2real.camera.render.bodies import Drawn, draw
from sim2real.camera.render.box import Box
from sim2real.camera.render.moment import Moment
from sim2real.camera.render.paint import Shape, paint
from sim2real.camera.render.sensor import Noise, Sensor
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import View

PER_PIXEL = 4  # instants at which something that moves by one pixel during the exposure is drawn
EMPTIES = 8  # pictures of the empty table that take turns where nothing moves: their noise repeats


class Renderer:
    """Pictures of `table` in `view`. The same seed, moment and number always give the same picture.

    >>> renderer = Renderer(table, View.like_the_real_one(table.length, table.width))
    >>> image = renderer.picture(Moment(puck=Motion(0.7, 0.4, vx=3.0)), number=17)

    The outline of whatever moves is projected with OpenCV and covers pixels by exact area; the puck's edge is where it
    should be to about 1e-3 pixels, which is 2 micrometres of the table. Only what moves is drawn anew.
    """

    def __init__(self, table: Table, view: View, sensor: Sensor | None = None, seed: int = 0) -> None:
        self.table, self.view = table, view
        self.sensor = sensor or Sensor()
        self._still = Background(table, view)
        self.box = self._still.box
        self._noise = Noise(self.box, seed)
        self._blurred = self.sensor.spread(self._still.light)
        self._empties: dict[int, np.ndarray] = {}

    def picture(self, moment: Moment, number: int = 0, box: Box | None = None) -> np.ndarray:
        """The picture uint8, (rows, columns) of `box` or of the whole frame; `number` chooses its noise."""
        box = self.box if box is None else box.common(self.box)
        image = self._empty(number % EMPTIES)[box.within(self.box)].copy()
        instants = self._instants(moment)
        for part in self._changed(instants, box):
            light = self._light(instants, part)
            image[part.within(box)] = self.sensor.levels(light, self._noise.of(number, part))
        return image

    def light(self, moment: Moment, box: Box | None = None) -> np.ndarray:
        """The same before noise and rounding, in grey levels without limit: float64 (rows, columns)."""
        box = self.box if box is None else box.common(self.box)
        light = self._blurred[box.within(self.box)].astype(float)
        instants = self._instants(moment)
        for part in self._changed(instants, box):
            light[part.within(box)] = self._light(instants, part)
        return light

    def box_of(self, moment: Moment, margin: int = 20) -> Box:
        """The pixels round the puck, where there is one: a region of interest."""
        if moment.puck is None:
            raise ValueError("the moment has no puck; give one that has, or take the whole frame")
        (puck,) = draw(Moment(puck=moment.puck), self.table, self.view).low
        return Box.around(puck.outline).wider(margin).common(self.box)

    def _empty(self, kind: int) -> np.ndarray:
        """The empty table with noise, uint8."""
        if kind not in self._empties:
            self._empties[kind] = self.sensor.levels(self._blurred, self._noise.of(kind, self.box))
        return self._empties[kind]

    def _instants(self, moment: Moment) -> list[Drawn]:
        """What moves, at evenly spread instants of the exposure: as many as its motion asks for."""
        speed = max((math.hypot(mover.vx, mover.vy) for mover in moment.movers), default=0.0)
        pixels = speed * self.sensor.exposure * self.view.matrix[0, 0] / self.view.place[2]  # at most, nearly
        count = max(math.ceil(PER_PIXEL * pixels), 1)
        times = ((np.arange(count) + 0.5) / count - 0.5) * self.sensor.exposure
        return [draw(_later(moment, float(time)), self.table, self.view) for time in times]

    def _changed(self, instants: list[Drawn], box: Box) -> list[Box]:
        """Parts of `box` in which something moves. Where they overlap, each shows all that is there."""
        parts: list[Box] = []
        for same in zip(*([*drawn.low, *drawn.high] for drawn in instants), strict=True):
            around = Box.around(np.concatenate([shape.outline for shape in same]))
            part = around.wider(self.sensor.reach).common(box)
            while near := next((p for p in parts if p.joined(part).pixels <= p.pixels + part.pixels), None):
                parts.remove(near)
                part = part.joined(near)
            parts.append(part)
        return [part for part in parts if not part.empty]

    def _light(self, instants: list[Drawn], box: Box) -> np.ndarray:
        """Blurred light float64 in `box`, averaged over the exposure."""
        wide = box.wider(self.sensor.reach).common(self.box)
        mean = np.mean([self._sharp(drawn, wide) for drawn in instants], axis=0)
        return self.sensor.spread(mean)[box.within(wide)]

    def _sharp(self, drawn: Drawn, box: Box) -> np.ndarray:
        """Light float64 at an instant, without blur."""
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


def _later(moment: Moment, time: float) -> Moment:
    movers = {name: getattr(moment, name) for name in ("puck", "opponent", "mallet")}
    return replace(moment, **{name: mover.after(time) for name, mover in movers.items() if mover})
