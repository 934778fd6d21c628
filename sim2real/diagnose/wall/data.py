"""The bounces of a recording off walls and posts as flat arrays, in the frame of each wall."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.physics import bounce
from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.impacts import Impact, Side

KINDS = {"x0": bounce.WALL_X0, "x1": bounce.WALL_X1, "y0": bounce.WALL_Y0, "y1": bounce.WALL_Y1}
SLOWEST = 0.05  # m/s along the normal; a slower touch is no clear bounce
LATE = 0.02  # s, by which the time of a hit may be wrong
UNUSUAL = 0.3  # difference of a restitution from the usual one that no wall makes
STRAY = 12.0  # standard deviations of a jump in place across a bounce that is none


@dataclass(frozen=True)
class Bounces:
    """`n` bounces. `kind` (n,) as in `bounce`; `normal` (n, 2); `t` (n,) [s]; `place`, `before`, `after` (n, 2) [SI].

    `spread` (n, 2, 2, 2): covariance of the velocity before and after, in axes along the normal and the tangent;
    `drift` (n, 2, 2, k): its changes, likewise, by each independent standard deviation of the law of the glides;
    `turn` (n,): std of the normal's angle; `chain` (n,): bounces of one number carry the spin on, which is unknown at
    the chain's start where `lost` (n,); `since` (n,) [s] after the contact before; `cluster` (n,).
    """

    kind: np.ndarray
    normal: np.ndarray
    t: np.ndarray
    place: np.ndarray
    before: np.ndarray
    after: np.ndarray
    spread: np.ndarray
    drift: np.ndarray
    turn: np.ndarray
    chain: np.ndarray
    lost: np.ndarray
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
    fields = list(zip(*rows, strict=True)) if rows else [[]] * 13
    known = impacts[0].before.drift.shape[1] if impacts else 0
    shapes = [(), (2,), (), (2,), (2,), (2,), (2, 2, 2), (2, 2, known), (), (), (), (), ()]
    kinds = [int, float, float, float, float, float, float, float, float, int, bool, float, int]
    arrays = [
        np.array(field, kind).reshape(len(rows), *shape)
        for field, kind, shape in zip(fields, kinds, shapes, strict=True)
    ]
    return _usual(Bounces(*arrays))


def _usual(every: Bounces) -> Bounces:
    """The bounces without hits at a wall of a quite unusual restitution: there something else was hit as well."""
    restitution = every.split(every.after)[:, 0] / every.closing
    wall = every.kind != bounce.POST
    middle = np.median(restitution[wall]) if wall.any() else 0.0
    kept = ~wall | (np.abs(restitution - middle) < UNUSUAL)
    return Bounces(*(getattr(every, name)[kept] for name in Bounces.__dataclass_fields__))


def _row(impact: Impact, g: Geometry):
    hit, before, after = impact.hit, impact.before, impact.after
    weight = [np.linalg.inv(side.covariance[:2, :2]) for side in (before, after)]
    sure = np.linalg.inv(weight[0] + weight[1])
    place = sure @ (weight[0] @ before.place + weight[1] @ after.place)
    if hit.kind == "post":
        post = g.post(hit.where)
        place = sure @ sum(
            w @ _on_circle(side, post, g.puck_radius) for w, side in zip(weight, (before, after), strict=True)
        )
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
    drift = np.stack([axes @ side.drift[2:] for side in (before, after)])
    return (
        kind, normal, hit.t, place, before.velocity, after.velocity, spread, drift, turn, impact.chain, impact.lost,
        impact.since, impact.cluster,
    )  # fmt: skip


def _meets(before: Side, after: Side) -> bool:
    """Whether the motions before and after lead to one place; otherwise something else happened in between."""
    apart = after.place - before.place
    return (
        float(apart @ np.linalg.solve(before.covariance[:2, :2] + after.covariance[:2, :2] + 1e-7 * np.eye(2), apart))
        < STRAY**2
    )


def _on_circle(side: Side, post: np.ndarray, radius: float) -> np.ndarray:
    """Where a motion touches the post: its place when it is `radius` away, at about the time of the hit."""
    away = side.place - post
    apart = float(np.linalg.norm(away))
    rate = float(side.velocity @ away) / apart
    return side.place + side.velocity * float(np.clip((radius - apart) / rate, -LATE, LATE)) if rate else side.place
