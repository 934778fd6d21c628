"""A live camera and the vision as the eyes of a table."""

from __future__ import annotations

from typing import Protocol

from sim2real.camera.frame import Frame, Source
from sim2real.table.backend import SeenFrame


class FrameReader(Protocol):
    """Finds puck and opponent in a frame."""

    def read(self, frame: Frame) -> SeenFrame:
        """What is seen in a frame, at the frame's own time; with what is wrong with it."""
        ...


class CameraClock(Protocol):
    """The camera's clock on the host's."""

    def add(self, camera: float, host: float) -> None:
        """Take a frame's time by the camera's clock and of its arrival by the host's [s]."""
        ...

    def to_host(self, camera: float) -> float:
        """The host's time [s] at a time of the camera's clock [s]."""
        ...
