"""Things that do not belong on the twin's table, as ellipses that lie over all else in its pictures."""

from __future__ import annotations

import numpy as np

from sim2real.camera.render.table import Glint
from sim2real.table.backend import Place
from sim2real.table.twin.rendered_table import RenderedTable

PALM, THICK = (0.06, 0.09), 0.04  # m: half-axes of a hand along x and y, and how high its back is above the table
DARK_SLEEVE, BARE_SKIN = 9.0, 50.0  # grey levels


def second_puck(place: Place, rendered: RenderedTable) -> Glint:
    """A second puck at a place [m]; unlike the first one, no gantry hides it."""
    table, (x, y) = rendered.table, place
    level = table.levels.puck * rendered.view.brightness_at(np.array([x, y, table.puck_height]))
    return Glint(x, y, table.puck_radius, table.puck_radius, level, table.puck_height)


def hand(place: Place, level: float = DARK_SLEEVE) -> Glint:
    """A hand over a place [m], which hides what is under it; level: its grey level."""
    return Glint(*place, *PALM, level, THICK)
