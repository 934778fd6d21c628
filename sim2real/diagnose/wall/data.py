"""The bounces of a recording off walls and posts as flat arrays, in the frame of each wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics import bounce
from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.impacts import Impact

KINDS = {"x0": bounce.WALL_X0, "x1": bounce.WALL_X1, "y0": bounce.WALL_Y0, "y1": bounce.WALL_Y1}
SLOWEST = 0.05  # m/s along the normal; a slower touch is no clear bounce
STRAY = 12.0  # standard deviations of a jump in place across a bounce that is none


@dataclass(frozen=True)
class Bounces:
    """`n` bounces. `kind` (n,) as in `bounce`; `normal` (n, 2); `t` (n,) [s]; `place`, `before`, `after` (n, 2) [m, m/s].

    `spread` (n, 2, 2, 2): covariance of the velocity before and after, in axes along the normal and the tangent;
    `turn` (n,): std of the normal's angle; `fresh` (n,): the spin before is unknown; `since` (n,) [s]; `cluster` (n,).
    """

    kind: np.ndarray
    normal: np.ndarray
    t: np.ndarray
    place: np.ndarray
    before: np.ndarray
    after: np.ndarray
    spread: np.ndarray
    turn: np.ndarray
    fresh: np.ndarray
    since: np.ndarray
    cluster: np.ndarray

    def __len__(self) -> int:
        return len(self.kind)

    def split(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 2) of the table as (normal, tangential) components (n, 2)."""
        nx, ny = self.normal.T
        return np.stack([vectors[:, 0] * nx + vectors[:, 1] * ny, vectors[:, 1] * nx - vectors[:, 0] * ny], axis=1)

    @property
    def closing(self) -> np.ndarray:
        """Normal speed (n,) [m/s] towards the wall."""
        return -self.split(self.before)[:, 0]


def bounces(impacts: list[Impact], g: Geometry) -> Bounces:
    """The clear bounces off walls and posts among `impacts`, in order of time."""
    rows = [row for impact in impacts if (row := _row(impact, g)) is not None]
    fields = list(zip(*rows, strict=True)) if rows else [[]] * 11
    shapes = [(), (2,), (), (2,), (2,), (2,), (2, 2, 2), (), (), (), ()]
    arrays = [np.array(field).reshape(len(rows), *shape) for field, shape in zip(fields, shapes, strict=True)]
    arrays[0], arrays[8], arrays[10] = arrays[0].astype(int), arrays[8].astype(bool), arrays[10].astype(int)
    return Bounces(*arrays)


def _row(impact: Impact, g: Geometry):
    hit, before, after = impact.hit, impact.before, impact.after
    weight = [np.linalg.inv(side.covariance[:2, :2]) for side in (before, after)]
    sure = np.linalg.inv(weight[0] + weight[1])
    place = sure @ (weight[0] @ before.place + weight[1] @ after.place)
    if hit.kind == "post":
        post = _post(hit.where, g)
        normal = (place - post) / np.linalg.norm(place - post)
        kind, turn = bounce.POST, float(np.sqrt(np.trace(sure) / 2)) / g.puck_radius
    elif hit.kind == "wall" and _meets(before, after):
        kind, normal, turn = KINDS[hit.where], hit.normal, 0.0
    else:
        return None
    if -(before.velocity @ normal) < SLOWEST:
        return None
    axes = np.array([normal, [-normal[1], normal[0]]])
    spread = np.stack([axes @ side.covariance[2:, 2:] @ axes.T for side in (before, after)])
    return (
        kind, normal, hit.t, place, before.velocity, after.velocity, spread, turn, impact.fresh, impact.since,
        impact.cluster,
    )  # fmt: skip


def _meets(before, after) -> bool:
    """Whether the motions before and after lead to one place; otherwise something else happened in between."""
    apart = after.place - before.place
    return float(apart @ np.linalg.solve(before.covariance[:2, :2] + after.covariance[:2, :2] + 1e-7 * np.eye(2), apart)) < STRAY**2


def _post(where: str, g: Geometry) -> np.ndarray:
    end, side = where.split()
    assert g.goal_width is not None
    sign = 1 if side == "left" else -1
    return np.array([0.0 if end == "x0" else g.length, g.width / 2 + sign * g.goal_width / 2])
