"""Contacts of the puck as flat arrays, each in the frame of its own normal."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, TypeVar

import numpy as np

from sim2real.diagnose.regimes.contact.motion import ContactMotion, ContactSide

FIELD_TYPES: dict[str, type] = {  # others: float
    "kind": int, "spin_chain": int, "spin_unknown": bool, "cluster": int, "recording": int
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Contacts:
    """`n` contacts of the puck, in order of time.

    `normal` (n, 2): unit vector towards the puck; `t` (n,) [s]; `place` (n, 2) [m] of the puck's centre;
    `velocity_before`, `velocity_after` (n, 2) [m/s] of the puck, in the table's frame.
    `velocity_covariance` (n, 2, 2, 2) [m^2/s^2]: covariances of the velocity before and of the velocity after due to
    sensor noise, in axes along the normal and the tangent. `common_errors` (n, 2, 2, k) [m/s]: changes of both
    velocities, in the same axes, by one standard deviation of each of k errors that all contacts share.
    `normal_std` (n,) [rad]: standard deviation of the normal's angle. `spin_chain` (n,): contacts with the same number
    share the puck's spin. `spin_unknown` (n,): whether the chain begins with an unknown spin. `cluster` (n,): the
    launch.
    """

    normal: np.ndarray
    t: np.ndarray
    place: np.ndarray
    velocity_before: np.ndarray
    velocity_after: np.ndarray
    velocity_covariance: np.ndarray
    common_errors: np.ndarray
    normal_std: np.ndarray
    spin_chain: np.ndarray
    spin_unknown: np.ndarray
    cluster: np.ndarray

    def __len__(self) -> int:
        return len(self.t)

    def components(self, vectors: np.ndarray) -> np.ndarray:
        """Vectors (n, 2) in the table's frame as (normal, tangential) components (n, 2)."""
        nx, ny = self.normal.T
        return np.stack([vectors[:, 0] * nx + vectors[:, 1] * ny, vectors[:, 1] * nx - vectors[:, 0] * ny], axis=1)

    @property
    def relative_velocity(self) -> np.ndarray:
        """Velocity (n, 2) [m/s] of the puck before the contact, relative to what it touches."""
        return self.velocity_before

    @property
    def closing_speed(self) -> np.ndarray:
        """Speed (n,) [m/s] of the approach along the normal."""
        return -self.components(self.relative_velocity)[:, 0]

    @property
    def tangential_velocity(self) -> np.ndarray:
        """Signed velocity (n,) [m/s] of the approach along the tangent."""
        return self.components(self.relative_velocity)[:, 1]

    @property
    def approach(self) -> np.ndarray:
        """Closing speed and tangential velocity (n, 2) [m/s]."""
        return np.stack([self.closing_speed, self.tangential_velocity], axis=1)

    @property
    def incidence_angle(self) -> np.ndarray:
        """Angle (n,) [rad] between the approach and the normal."""
        return np.arctan2(np.abs(self.tangential_velocity), self.closing_speed)

    @property
    def axes(self) -> np.ndarray:
        """Unit vectors (n, 2, 2) along the normal and the tangent."""
        return np.stack([self.normal, np.stack([-self.normal[:, 1], self.normal[:, 0]], axis=1)], axis=1)


AnyContacts = TypeVar("AnyContacts", bound=Contacts)


def make_contacts(
    record: type[AnyContacts],
    rows: Sequence[dict[str, Any]],
    contact_motions: Sequence[ContactMotion],
    shapes: Mapping[str, tuple[int, ...]],
) -> AnyContacts:
    """Make contacts of the class `record` from their fields, one dict for each contact.

    `contact_motions`: the source of the rows; `shapes`: shapes of the non-scalar fields that the class adds.
    """
    common = contact_motions[0].before.common_errors.shape[1] if contact_motions else 0
    pair = dict.fromkeys(("normal", "place", "velocity_before", "velocity_after"), (2,))
    shapes = {**pair, "velocity_covariance": (2, 2, 2), "common_errors": (2, 2, common), **shapes}
    columns = {}
    for name in (one.name for one in fields(record)):
        column = np.array([row[name] for row in rows], FIELD_TYPES.get(name, float))
        columns[name] = column.reshape(len(rows), *shapes.get(name, ()))
    return record(**columns)


def select_contacts(contacts: AnyContacts, which: np.ndarray) -> AnyContacts:
    """The contacts for which `which` (n,) bool is true."""
    return type(contacts)(**{one.name: getattr(contacts, one.name)[which] for one in fields(contacts)})


def join_contacts(parts: Sequence[AnyContacts]) -> AnyContacts:
    """Concatenate the contacts of several recordings; their clusters must already be numbered over all of them."""
    names = [one.name for one in fields(parts[0])]
    return type(parts[0])(**{name: np.concatenate([getattr(part, name) for part in parts]) for name in names})


def common_place_variance(before: ContactSide, after: ContactSide) -> float:
    """Variance [m^2] of each coordinate of a contact's place due to the errors that all contacts share."""
    return float(np.sum((0.5 * (before.common_errors[:2] + after.common_errors[:2])) ** 2)) / 2.0


def velocity_errors(normal: np.ndarray, before: ContactSide, after: ContactSide) -> dict[str, np.ndarray]:
    """The fields `velocity_covariance` and `common_errors` of a contact with this normal (2,)."""
    axes = np.array([normal, [-normal[1], normal[0]]])
    return {
        "velocity_covariance": np.stack([axes @ side.covariance[2:, 2:] @ axes.T for side in (before, after)]),
        "common_errors": np.stack([axes @ side.common_errors[2:] for side in (before, after)]),
    }
