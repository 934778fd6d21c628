"""The blows of the robot's mallet as flat arrays, each in the frame of its line of centres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.encoders import Encoders
from sim2real.diagnose.impacts import Impact

SLOWEST = 0.1  # m/s of closing; a slower touch is no clear blow
LONGEST_WAY = 0.012  # s between the hit and the moment at which the motions before and after meet
FARTHEST = 0.006  # m between the rims at a blow


@dataclass(frozen=True)
class Blows:
    """`n` blows. `normal` (n, 2) from mallet to puck; `t` (n,) [s]; `place` of the puck, its velocity `before` and
    `after`, the mallet's `driven` just before (n, 2) [m, m/s], and the `step` (n,) of that along the normal.

    Covariances in axes along the normal and the tangent: `spread` (n, 2, 2, 2) of the velocity before and after;
    `drift` (n, 2, 2, k): changes of the former by each independent standard deviation of the law of the glides;
    `swing` (n, 3, 3) of `driven` and `step`. `turn` (n,): std of the normal's angle; `cluster` (n,).
    `chain` (n,): blows of one number carry the puck's spin on, which is unknown where `lost` (n,).
    """

    normal: np.ndarray
    t: np.ndarray
    place: np.ndarray
    before: np.ndarray
    after: np.ndarray
    driven: np.ndarray
    step: np.ndarray
    spread: np.ndarray
    drift: np.ndarray
    swing: np.ndarray
    turn: np.ndarray
    cluster: np.ndarray
    chain: np.ndarray
    lost: np.ndarray

    def __len__(self) -> int:
        return len(self.t)

    def split(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 2) of the table as (normal, tangential) components (n, 2)."""
        nx, ny = self.normal.T
        return np.stack([vectors[:, 0] * nx + vectors[:, 1] * ny, vectors[:, 1] * nx - vectors[:, 0] * ny], axis=1)

    @property
    def closing(self) -> np.ndarray:
        """Speed (n,) [m/s] at which puck and mallet approach."""
        return -self.split(self.before - self.driven)[:, 0]


def blows(impacts: Sequence[Impact], encoders: Encoders, g: Geometry) -> Blows:
    """The clear blows of the robot's mallet among the impacts of one recording, in order of time."""
    foreign = {impact.chain: impact.hit.t for impact in reversed(impacts) if impact.hit.where == "opponent"}
    rows = [
        (*row, impact.cluster, impact.chain, impact.lost or impact.hit.t > foreign.get(impact.chain, np.inf))
        for impact in impacts
        if (row := _row(impact, encoders, g)) is not None
    ]
    fields = list(zip(*rows, strict=True)) if rows else [[]] * 14
    known = impacts[0].before.drift.shape[1] if impacts else 0
    shapes = [(2,), (), (2,), (2,), (2,), (2,), (), (2, 2, 2), (2, 2, known), (3, 3), (), (), (), ()]
    kinds = [float] * 11 + [int, int, bool]
    arrays = [np.array(f, k).reshape(len(rows), *s) for f, k, s in zip(fields, kinds, shapes, strict=True)]
    return Blows(*arrays)


def join(parts: Sequence[Blows]) -> Blows:
    """The blows of several recordings, whose clusters are numbered through already."""
    return Blows(*(np.concatenate([getattr(part, name) for part in parts]) for name in Blows.__dataclass_fields__))


def _row(impact: Impact, encoders: Encoders, g: Geometry):
    if impact.hit.where != "robot":
        return None
    before, after = impact.before, impact.after
    change = after.velocity - before.velocity
    later = -float((after.place - before.place) @ change) / max(float(change @ change), 1e-9)
    t = impact.hit.t + later
    place = before.place + before.velocity * later
    mallet = encoders.at(np.array(t))
    blow = encoders.blow(t)
    if abs(later) > LONGEST_WAY or blow is None or not np.isfinite(mallet).all():
        return None
    away = place - mallet
    apart = float(np.linalg.norm(away))
    normal = away / apart
    axes = np.array([normal, [-normal[1], normal[0]]])
    driven, step, covariance = blow
    touch = g.puck_radius + g.mallet_radius
    if abs(apart - touch) > FARTHEST or (driven - before.velocity) @ normal < SLOWEST:
        return None
    spread = np.stack([axes @ side.covariance[2:, 2:] @ axes.T for side in (before, after)])
    swing = np.zeros((3, 3))
    for axis in (0, 1):  # the encoders' axes err apart from each other
        onto = np.array([[axes[0, axis], 0.0], [axes[1, axis], 0.0], [0.0, axes[0, axis]]])
        swing += onto @ covariance[axis] @ onto.T
    std = np.sqrt(np.trace(before.covariance[:2, :2] + after.covariance[:2, :2]) / 8) + encoders.noise
    return (
        normal,
        t,
        place,
        before.velocity,
        after.velocity,
        driven,
        step @ normal,
        spread,
        np.stack([axes @ side.drift[2:] for side in (before, after)]),
        swing,
        std / touch,
    )
