"""Tables of the twin whose physics is concealed from all that plays, diagnoses and learns: a row each.

Each is sized by what it costs a player that learnt with what is true of every table: a quarter of its score or more,
against a hand that it does not hinder.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np

from puckpilot_env.files.toml_file import refuse_unknown
from puckpilot_env.parameters import BY_NAME
from puckpilot_env.physics.effects import unlisted_force
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.twin import law_of


@dataclass(frozen=True)
class ConcealedTable:
    """words: of what is in it; law: fields of the independent table's `Law`; errors: of its camera; truth: the same by
    the simulator's names, for the ceiling alone."""

    words: str
    law: Mapping[str, Any] = field(default_factory=dict)
    errors: CameraErrors = field(default_factory=CameraErrors)
    truth: Mapping[str, float] = field(default_factory=dict)

    def twin_options(self, p: np.void) -> dict[str, Any]:
        """What `Twin` takes to be this table, with the baseline's parameters `p`."""
        return {"law": replace(law_of(p), hand=True, **self.law), "errors": self.errors}


def _alike(words: str, law: Mapping[str, Any], late: float = 0.0, **others: float) -> ConcealedTable:
    """A table of effects that have the same names in law and simulator, but for the `others`: the simulator's; and a
    camera whose stamps are `late` [s]."""
    truth = {name: value for name, value in law.items() if name in BY_NAME} | others
    return ConcealedTable(words, law, CameraErrors(stamp_late=late), truth)


def _braking(law: Mapping[str, Any]) -> dict[str, float]:
    """The simulator's table of a cubic drag."""
    speeds = np.linspace(0.0, 4.3, unlisted_force.SPEED_KNOTS)
    numbers = np.concatenate([speeds, law["cubic_drag"] * speeds**3])
    return {"unlisted_kind": unlisted_force.BRAKE_BY_SPEED} | {
        f"unlisted_{k:02}": float(number) for k, number in enumerate(numbers)
    }


_FRICTION = {
    "motor_friction_left": 0.42, "motor_friction_right": 0.36, "axis_friction_x": 0.12, "axis_friction_y": 0.48,
    "voltage_sag": 0.005,
}  # fmt: skip
_SPIN = {"wall_spin": True, "wall_mu": 0.3, "restitution_slope": 0.1}
_WARP = {"tilt_x": -0.2, "tilt_y": 0.1, "warp_xx": 0.5, "warp_yy": -0.25}
_PATCH = {"patch_x": 1.4, "patch_y": 0.5, "patch_radius": 0.5, "patch_friction": 2.0}
_SOFT = {"mallet_give": 0.03, "mallet_restitution_slope": 0.02}
_CUBIC = {"cubic_drag": 0.06}

TABLES = {
    "none": ConcealedTable("nothing: the control"),
    "warp": _alike("a tilt and a warp", _WARP),
    "walls": _alike("walls that spin the puck, and give back less of a fast one", _SPIN),
    "mallet": _alike("a mallet that recoils, and has less restitution at speed", _SOFT),
    "friction": _alike("friction of the motors, and voltage that sags", _FRICTION),
    "late": _alike("commands and a camera that are late", {"command_delay": 0.005}, late=0.015),
    "patch": _alike("a patch that brakes the puck", _PATCH, patch_extra=_PATCH["patch_friction"]),
    "unlisted": _alike("a drag that grows with the cube of speed, which is not listed", _CUBIC, **_braking(_CUBIC)),
    "everything": _alike(
        "a warp, spinning walls, a soft mallet, friction, a late camera",
        {
            **_FRICTION, "wall_spin": True, "wall_mu": 0.2, "restitution_slope": 0.05, "mallet_give": 0.015,
            "mallet_restitution_slope": 0.01, "tilt_x": -0.1, "warp_xx": 0.2,
        },
        late=0.01,
    ),
}  # fmt: skip


def find_table(name: str) -> ConcealedTable:
    """The concealed table of this name. ValueError, in one line, for an unknown one."""
    refuse_unknown([name], TABLES, "concealed table")
    return TABLES[name]
