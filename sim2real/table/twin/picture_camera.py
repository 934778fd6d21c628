"""The twin's camera that takes pictures: the plant's state is rendered, and the vision finds what is in the picture."""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import cv2
import numpy as np

from sim2real.camera.frame import Frame
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import BodyState, SceneState
from sim2real.camera.render.table import Glint
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.physical.frame_reader import FrameReader
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.coming_frames import ComingFrames
from sim2real.table.twin.plant import Plant
from sim2real.table.twin.rendered_table import RenderedTable

NUMBERS = 1 << 20  # pictures of a seed; in those of another one, what moves has other noise


@dataclass
class Disturbances:
    """What is wrong with the scene; all of it may be set at any time.

    light: brightness as a share of the usual; things: ellipses over table and bodies, a hand or a second puck say, see
    `things.py`.
    """

    light: float = 1.0
    things: tuple[Glint, ...] = ()


class PictureCamera(ComingFrames):
    """Takes pictures of a plant at its `errors.rate`, the first at half a period, which shows where the camera is.

    rendered: the table as it is calibrated; renderer: draws it; `renderer` may be replaced by one of a table or a view
    that was changed since, as by a knock; errors: rate, delay and clock, while the noise is the pictures' own.
    """

    def __init__(self, rendered: RenderedTable, renderer: Renderer, errors: CameraErrors, seed: int) -> None:
        super().__init__()
        self.errors, self.rendered, self.renderer, self.scene = errors, rendered, renderer, Disturbances()
        self.unplugged = False
        self._reader = FrameReader(rendered.calibration(), rendered.targets())
        self._seed, self._taken = seed, 0

    @property
    def next_exposure(self) -> float:
        """When the next frame is exposed [s]."""
        return (self._taken + 0.5) / self.errors.rate

    def expose(self, plant: Plant) -> None:
        """Take a picture of the plant as it is now, and find what is in it. TableFaultError, in one line, if the first
        one does not show where the camera is."""
        missed = plant.time > self.next_exposure + 0.5 / self.errors.rate  # while the board booted
        number, self._taken = self._taken, self._taken + 1
        if not (self.unplugged or missed):
            frame = Frame(self.picture(plant, number), plant.time, plant.time, number)
            try:
                seen = replace(self._reader.read(frame), time=self.errors.stamp(plant.time))
                self.add(plant.time + self.errors.delay, seen)
                self._reader.check()
            except ValueError as error:
                raise TableFaultError(Cause.CAMERA_TROUBLE, f"{error}; then connect anew") from None

    def picture(self, plant: Plant, number: int) -> np.ndarray:
        """The picture uint8 (rows, columns) of the plant as it is now; `number` selects its noise."""
        puck = BodyState(*plant.puck.tolist())
        robot, opponent = (BodyState(*plant.mallet(which)) for which in range(2))
        state = SceneState(
            plant.time, puck if math.isfinite(puck.x) else None, opponent, robot, self.scene.things
        )  # fmt: skip
        image = self.renderer.picture(state, self._seed * NUMBERS + number)
        return image if self.scene.light == 1.0 else cv2.convertScaleAbs(image, alpha=self.scene.light)
