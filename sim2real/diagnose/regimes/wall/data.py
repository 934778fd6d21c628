"""The contacts of a recording with walls and posts as flat arrays, each in the frame of its normal."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from puckpilot_env.physics.contacts import bounce
from sim2real.diagnose.regimes.contact.data import (
    Contacts,
    common_place_variance,
    make_contacts,
    select_contacts,
    velocity_errors,
)
from sim2real.diagnose.regimes.contact.motion import ContactMotion, ContactSide
from sim2real.diagnose.regimes.wall.tuned import WALL
from sim2real.segmentation.causes import Geometry

KINDS = {"x0": bounce.WALL_X0, "x1": bounce.WALL_X1, "y0": bounce.WALL_Y0, "y1": bounce.WALL_Y1}


@dataclass(frozen=True, kw_only=True)
class WallContacts(Contacts):
    """Contacts with walls and posts.

    `kind` (n,): the simulator's number of the wall, or `bounce.POST`; `time_since_contact` (n,) [s]: time since the
    previous contact, nan if unknown.
    """

    kind: np.ndarray
    time_since_contact: np.ndarray


def wall_contacts(
    contact_motions: list[ContactMotion], geometry: Geometry, known: WallContacts | None = None
) -> WallContacts:
    """Select the clear contacts with walls and posts among `contact_motions`, in order of time.

    Outliers are detected relative to the contacts `known`, or relative to these contacts if `known` is empty.
    """
    rows = {k: row for k, motion in enumerate(contact_motions) if (row := _fields(motion, geometry)) is not None}
    every = make_contacts(WallContacts, list(rows.values()), contact_motions, {})
    usual = is_usual(every, known if known is not None and len(known) else every)
    number = np.array(list(rows), int)[usual]
    spin_chains = np.array([motion.spin_chain for motion in contact_motions], int)
    return split_spin_chains(select_contacts(every, usual), number, spin_chains)


def is_usual(every: WallContacts, known: WallContacts) -> np.ndarray:
    """Whether each contact (n,) bool has a restitution near the median of its wall, and changes the velocity along it
    by no more than friction and the loss of all of it can; True for every post contact.

    Any other contact touched something else as well, a mallet beside the wall, say. For a wall with few contacts in
    `known` the median of all walls is used.
    """
    restitution, known_restitution = (
        some.components(some.velocity_after)[:, 0] / some.closing_speed for some in (every, known)
    )
    wall, known_wall, usual = every.kind != bounce.POST, known.kind != bounce.POST, np.zeros(len(every))
    for kind in np.unique(every.kind[wall]):
        own = known.kind == kind
        own = own if own.sum() >= WALL.fewest_of_wall else known_wall
        median = np.median(known_restitution[own]) if own.any() else np.median(restitution[wall])
        usual[every.kind == kind] = median
    normal_change, change_along = np.abs(every.components(every.velocity_after - every.velocity_before)).T
    possible = change_along <= np.abs(every.tangential_velocity) + WALL.most_friction * normal_change
    return ~wall | ((np.abs(restitution - usual) < WALL.most_unusual_restitution) & possible)


def place_along_wall(data: WallContacts) -> np.ndarray:
    """Places (n,) [m] along the walls: y at the short ones, x elsewhere."""
    return np.where(at_short_walls(data), data.place[:, 1], data.place[:, 0])


def at_short_walls(data: WallContacts) -> np.ndarray:
    """Which (n,) bool are at a short wall."""
    return (data.kind == KINDS["x0"]) | (data.kind == KINDS["x1"])


def split_spin_chains(contacts: WallContacts, number: np.ndarray, spin_chains: np.ndarray) -> WallContacts:
    """Split the spin chains at omitted contacts, because the spin after an omitted contact is unknown.

    number: index (n,) of each contact among all motions; spin_chains: the chain (m,) of each motion.
    """
    chain, spin_unknown = np.arange(len(contacts)), contacts.spin_unknown.copy()
    for i, k in enumerate(number):
        within = k > 0 and spin_chains[k] == spin_chains[k - 1]
        if within and i > 0 and number[i - 1] == k - 1:
            chain[i], spin_unknown[i] = chain[i - 1], spin_unknown[i - 1]
        else:
            spin_unknown[i] |= within
    return replace(contacts, spin_chain=chain, spin_unknown=spin_unknown)


def _fields(motion: ContactMotion, geometry: Geometry) -> dict[str, Any] | None:
    """The fields of a contact with a wall or post; None if it is not a clear one."""
    contact, before, after = motion.contact, motion.before, motion.after
    weights = [np.linalg.inv(side.covariance[:2, :2]) for side in (before, after)]
    covariance = np.linalg.inv(weights[0] + weights[1])
    place = covariance @ (weights[0] @ before.place + weights[1] @ after.place)
    if contact.kind == "post":
        post = geometry.post(contact.where)
        place = covariance @ sum(
            weight @ _place_touching(side, post, geometry.puck_radius)
            for weight, side in zip(weights, (before, after), strict=True)
        )
        normal = (place - post) / np.linalg.norm(place - post)
        place_std = float(np.sqrt(np.trace(covariance) / 2 + common_place_variance(before, after)))
        kind, normal_std = bounce.POST, place_std / geometry.puck_radius
    elif contact.kind == "wall" and _sides_meet(before, after):
        kind, normal, normal_std = KINDS[contact.where], contact.normal, 0.0
    else:
        return None
    if -(before.velocity @ normal) < WALL.least_closing_speed:
        return None
    return {
        "kind": kind, "normal": normal, "t": contact.t, "place": place, "velocity_before": before.velocity,
        "velocity_after": after.velocity, "normal_std": normal_std, "spin_chain": motion.spin_chain,
        "spin_unknown": motion.spin_unknown, "time_since_contact": motion.time_since_contact, "cluster": motion.cluster,
        **velocity_errors(normal, before, after),
    }  # fmt: skip


def _sides_meet(before: ContactSide, after: ContactSide) -> bool:
    """Whether the motions before and after meet at one place; if not, something else happened between them."""
    jump = after.place - before.place
    covariance = before.covariance[:2, :2] + after.covariance[:2, :2] + 1e-7 * np.eye(2)
    return float(jump @ np.linalg.solve(covariance, jump)) < WALL.most_unusual_place**2


def _place_touching(side: ContactSide, post: np.ndarray, radius: float) -> np.ndarray:
    """Place (2,) [m] at which the motion is `radius` [m] from the post, near the time of the contact."""
    away = side.place - post
    distance = float(np.linalg.norm(away))
    rate = float(side.velocity @ away) / distance
    if not rate:
        return side.place
    return side.place + side.velocity * float(np.clip((radius - distance) / rate, -WALL.time_error, WALL.time_error))
