"""The twin's table as it is rendered: its sizes, the camera's view, and the calibration with which its pictures are
read."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.track.blobs import LEVEL
from sim2real.vision.track.tracker import Targets
from sim2real.vision.trial.rendered_calibration import exact_calibration


@dataclass(frozen=True)
class RenderedTable:
    """The table and the camera's view of it, with which pictures are drawn."""

    table: Table
    view: CameraView

    @classmethod
    def of(cls, p: np.void) -> RenderedTable:
        """A table with a game's parameters, seen as the real one is."""
        length, width, puck, mallet = (
            float(p[name]) for name in ("length", "width", "puck_radius", "mallet_radius")
        )  # fmt: skip
        table = replace(Table.with_markers(length, width), puck_radius=puck, mallet_radius=mallet)
        return cls(table, CameraView.like_the_real_one(length, width))

    def calibration(self) -> TableCalibration:
        """What `calibrate table` would find, without its errors; where the camera is has to be found in a picture."""
        return exact_calibration(self.table, self.view)

    def targets(self) -> Targets:
        """What is looked for in pictures."""
        return Targets(self.table.puck_radius, self.table.ring_height, LEVEL)
