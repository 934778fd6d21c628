"""What bounces and blows have in common: flat arrays of contacts, each in the frame of its own normal."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np

from sim2real.diagnose.impacts import Impact, Side

TYPES: dict[str, type] = {"kind": int, "chain": int, "lost": bool, "cluster": int}  # of a field; float, if not here


@dataclass(frozen=True, kw_only=True)
class Contacts:
    """`n` contacts of the puck, in order. `normal` (n, 2) towards the puck; `t` (n,) [s]; `place` of the puck and its
    velocities `before`, `after` (n, 2) [SI].

    `spread` (n, 2, 2, 2): covariance of the velocity before and after, in axes along the normal and the tangent;
    `drift` (n, 2, 2, k): its changes, likewise, by each independent standard deviation of the law of the glides;
    `turn` (n,): std of the normal's angle; `chain` (n,): contacts of one number carry the puck's spin on, which is
    unknown where `lost` (n,); `cluster` (n,): the launch.
    """

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
    cluster: np.ndarray

    def __len__(self) -> int:
        return len(self.t)

    def split(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 2) of the table as (normal, tangential) components (n, 2)."""
        nx, ny = self.normal.T
        return np.stack([vectors[:, 0] * nx + vectors[:, 1] * ny, vectors[:, 1] * nx - vectors[:, 0] * ny], axis=1)

    @property
    def approach(self) -> np.ndarray:
        """Velocity (n, 2) [m/s] of the puck before, past what it hits."""
        return self.before

    @property
    def closing(self) -> np.ndarray:
        """Speed (n,) [m/s] of the approach along the normal."""
        return -self.split(self.approach)[:, 0]

    @property
    def sliding(self) -> np.ndarray:
        """Signed speed (n,) [m/s] of the approach along the tangent."""
        return self.split(self.approach)[:, 1]

    @property
    def angle(self) -> np.ndarray:
        """Angle (n,) [rad] of the approach from the normal."""
        return np.arctan2(np.abs(self.sliding), self.closing)

    @property
    def axes(self) -> np.ndarray:
        """Unit vectors (n, 2, 2) along the normal and the tangent."""
        return np.stack([self.normal, np.stack([-self.normal[:, 1], self.normal[:, 0]], axis=1)], axis=1)


C = TypeVar("C", bound=Contacts)


def contacts_of(
    kind: type[C], rows: Sequence[dict[str, Any]], impacts: Sequence[Impact], shapes: dict[str, tuple[int, ...]]
) -> C:
    """Contacts of a `kind` from its fields for each, a dict a row; `shapes` of those that are no numbers, beyond the
    ones that all kinds have. `impacts`: where the rows come from."""
    known = impacts[0].before.drift.shape[1] if impacts else 0
    pair = dict.fromkeys(("normal", "place", "before", "after"), (2,))
    shapes = {**pair, "spread": (2, 2, 2), "drift": (2, 2, known), **shapes}
    columns = {}
    for name in (one.name for one in fields(kind)):
        column = np.array([row[name] for row in rows], TYPES.get(name, float))
        columns[name] = column.reshape(len(rows), *shapes.get(name, ()))
    return kind(**columns)


def kept(contacts: C, which: np.ndarray) -> C:
    """Those of the contacts that `which` (n,) bool says."""
    return type(contacts)(**{one.name: getattr(contacts, one.name)[which] for one in fields(contacts)})


def join(parts: Sequence[C]) -> C:
    """The contacts of several recordings, whose clusters are numbered through already."""
    names = [one.name for one in fields(parts[0])]
    return type(parts[0])(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def shared_variance(before: Side, after: Side) -> float:
    """Variance [m^2] of each coordinate of a contact's place, between two motions, by what all contacts have in common:
    the glides' law and the camera's calibration."""
    return float(np.sum((0.5 * (before.drift[:2] + after.drift[:2])) ** 2)) / 2.0


def in_axes(normal: np.ndarray, before: Side, after: Side) -> dict[str, np.ndarray]:
    """The fields `spread` and `drift` of a contact of this normal (2,), between two motions."""
    axes = np.array([normal, [-normal[1], normal[0]]])
    return {
        "spread": np.stack([axes @ side.covariance[2:, 2:] @ axes.T for side in (before, after)]),
        "drift": np.stack([axes @ side.drift[2:] for side in (before, after)]),
    }
