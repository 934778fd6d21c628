"""All that a bounce may lack, as columns of its residuals: the listed effects, and smooth laws of any shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.contact_laws import UNIT, contact_columns
from sim2real.diagnose.engine.choose import Law
from sim2real.diagnose.piecewise import memory_hats, ripples, spread_hats
from sim2real.diagnose.problem import Columns
from sim2real.diagnose.wall.data import KINDS, Bounces

if TYPE_CHECKING:
    from sim2real.diagnose.wall.problem import WallProblem

FRICTIONS = (0.04, 0.07, 0.1, 0.15, 0.2, 0.3, 0.5)  # at which friction with spin is looked for
KNOTS = 5  # of a smooth law
WAVES, RIPPLES = 4, 10  # of cosines along each wall, and along all alike
ONE_ROW_EACH = ("wall_to_wall_restitution", "speed_dependent_restitution")


def wall_columns(problem: WallProblem, values: Mapping[str, float], free: Sequence[str]) -> Columns:
    """Every column of a wall problem at one law."""
    friction = ("wall_friction_spin", "wall_mu", FRICTIONS)
    return contact_columns(problem, values, free, _smooth_in_the_effect(), friction, FAMILIES)


def _smooth_in_the_effect() -> list[Law]:
    """Listed effects whose columns are derivatives at the baseline; each wall's own restitution is one, and so is each
    form of the fall with speed."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime not in ("wall", "corner") or name == "wall_friction_spin":
            continue
        if name in ONE_ROW_EACH:
            found += [Law(name, (row,)) for row in effect.row_names]
        else:
            found.append(Law(name, effect.row_names))
    return found


def _along_walls(data: Bounces) -> np.ndarray:
    """Cosines of the place along each wall (n, 4 WAVES), with which a restitution may vary."""
    columns = []
    for kind in KINDS.values():
        here = data.kind == kind
        s = data.place[:, 1 if kind in (KINDS["x0"], KINDS["x1"]) else 0]
        span = max(float(s[here].max()), 1e-3) if here.any() else 1.0
        columns += [np.where(here, np.cos(np.pi * k * s / span), 0.0) for k in range(WAVES)]
    return np.stack(columns, axis=1)


def _by_place(data: Bounces) -> np.ndarray:
    """Ripples (n, RIPPLES) of how far along its wall a bounce is: along x at the long walls, along y at the short ones;
    nothing at a post."""
    short = (data.kind == KINDS["x0"]) | (data.kind == KINDS["x1"])
    span = np.maximum(data.place.max(axis=0, initial=0.0), 1e-3)
    share = np.where(short, data.place[:, 1] / span[1], data.place[:, 0] / span[0])
    return ripples(share, RIPPLES) * np.isin(data.kind, list(KINDS.values()))[:, None]


FAMILIES: dict[str, tuple[str, Callable[[Bounces], np.ndarray]]] = {
    "speed": ("speed", lambda d: spread_hats(d.closing, KNOTS)),
    "angle": ("heading", lambda d: spread_hats(d.angle, KNOTS)),
    "place": ("position", _along_walls),
    "place alike on all walls": ("position", _by_place),
    "time": ("time", lambda d: spread_hats(d.t, KNOTS)),
    "time since a contact": ("history", lambda d: memory_hats(d.since, KNOTS)),
}


def shares(data: Bounces, law: Law) -> np.ndarray:
    """What the coefficients of a smooth law add (n, k) to the share of a speed that each bounce keeps."""
    return UNIT * FAMILIES[law.name.split(" by ", 1)[1]][1](data)
