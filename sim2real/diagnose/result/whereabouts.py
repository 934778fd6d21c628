"""The place on the table at which a law acts, in the terms of the format."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law

LEAST_ANGLE = 3e-4  # rad, of a wall that is said to be turned: half a millimetre on a table's length


def whereabouts(law: Law, values: Mapping[str, float]) -> dict[str, Any]:
    """Return the walls, the area of the table or the stream on which a listed law acts; empty if it acts everywhere."""
    if law.name == "friction_patch":
        x, y, radius = (float(values[name]) for name in ("patch_x", "patch_y", "patch_radius"))
        return {"x": [x - radius, x + radius], "y": [y - radius, y + radius]}
    if law.name == "wall_to_wall_restitution":
        rows = EFFECTS[law.name].rows
        return {"walls": [wall for wall, row in rows.items() if row.name in law.columns]}
    if law.name == "wall_alignment":
        rows = EFFECTS[law.name].rows
        return {"walls": [wall for wall, row in rows.items() if abs(values.get(row.name, 0.0)) >= LEAST_ANGLE]}
    if law.name == "clock_drift":
        return {"stream": "mallet"}
    return {}
