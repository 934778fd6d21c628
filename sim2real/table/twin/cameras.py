"""The twin's cameras by name."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from sim2real.table.twin.camera import CameraErrors, TwinCamera
from sim2real.table.twin.watcher import Watcher

CAMERAS = ("places", "pictures")


def camera_maker(name: str, p: np.void, errors: CameraErrors) -> Callable[[int], Watcher]:
    """What makes the camera of this name over a table with parameters `p`, from a seed. ValueError, in one line, for an
    unknown name."""
    if name not in CAMERAS:
        raise ValueError(f"unknown camera '{name}'; expected {' or '.join(CAMERAS)}")
    if name == "places":
        return lambda seed: TwinCamera(errors, seed)
    from sim2real.camera.render.renderer import Renderer
    from sim2real.table.twin.picture_camera import PictureCamera
    from sim2real.table.twin.rendered_table import RenderedTable

    rendered = RenderedTable.of(p)
    renderer = Renderer(rendered.table, rendered.view)
    return lambda seed: PictureCamera(rendered, renderer, errors, seed)
