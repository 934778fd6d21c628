"""The contacts of a recording with the robot's mallet as flat arrays, each in the frame of its line of centres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim2real.diagnose.regimes.contact.data import Contacts, common_place_variance, make_contacts, velocity_errors
from sim2real.diagnose.regimes.contact.motion import ContactMotion
from sim2real.diagnose.regimes.mallet.tuned import MALLET
from sim2real.segmentation.causes import Geometry, nominal_lines
from sim2real.segmentation.mallet_path import MalletPath


@dataclass(frozen=True, kw_only=True)
class MalletContacts(Contacts):
    """Contacts with the robot's mallet.

    `mallet_velocity` (n, 2) [m/s]: velocity of the mallet just before, in the table's frame; `mallet_step` (n,) [m/s]:
    its change at the contact, along the normal; `mallet_covariance` (n, 3, 3) [m^2/s^2]: covariance of the velocity
    along the normal and the tangent, and of the step. `turning` (n,) [rad/s], `mallet_acceleration` (n, 2) [m/s^2]: by
    how much the normal's angle and the mallet's velocity are wrong for each second by which the mallet's clock is early
    against the camera's; `recording` (n,): number of the recording, each of which has such an error of its own.
    """

    mallet_velocity: np.ndarray
    mallet_step: np.ndarray
    mallet_covariance: np.ndarray
    turning: np.ndarray
    mallet_acceleration: np.ndarray
    recording: np.ndarray

    @property
    def relative_velocity(self) -> np.ndarray:
        """Velocity (n, 2) [m/s] of the puck before the contact, relative to the mallet."""
        return self.velocity_before - self.mallet_velocity


def mallet_contacts(
    contact_motions: Sequence[ContactMotion], path: MalletPath, geometry: Geometry, recording: int = 0
) -> MalletContacts:
    """Select the clear contacts with the robot's mallet among the motions of one recording, in order of time;
    `recording`: its number."""
    opponent = {  # first contact of each spin chain with the opponent's mallet; the spin after it is unknown
        motion.spin_chain: motion.contact.t
        for motion in reversed(contact_motions)
        if motion.contact.where == "opponent"
    }
    rows = [
        {
            **row,
            "recording": recording,
            "spin_unknown": motion.spin_unknown or motion.contact.t > opponent.get(motion.spin_chain, np.inf),
        }
        for motion in contact_motions
        if (row := _fields(motion, path, geometry)) is not None
    ]
    shapes = {"mallet_velocity": (2,), "mallet_covariance": (3, 3), "mallet_acceleration": (2,)}
    return make_contacts(MalletContacts, rows, contact_motions, shapes)


def _fields(motion: ContactMotion, path: MalletPath, geometry: Geometry) -> dict[str, Any] | None:
    """The fields of a contact with the robot's mallet except those of the recording; None if it is not a clear one."""
    if motion.contact.where != "robot":
        return None
    before, after = motion.before, motion.after
    change = after.velocity - before.velocity
    delay = -float((after.place - before.place) @ change) / max(float(change @ change), 1e-9)
    t = motion.contact.t + delay
    place = before.place + before.velocity * delay
    mallet = path.at(np.array(t))
    mallet_motion = path.motion_at_contact(t)
    if abs(delay) > MALLET.longest_delay or mallet_motion is None or not np.isfinite(mallet).all():
        return None
    away = place - mallet
    distance = float(np.linalg.norm(away))
    normal = away / distance
    velocity, step, covariance, acceleration = mallet_motion
    radii = geometry.puck_radius + geometry.mallet_radius
    closing_speed = (velocity - before.velocity) @ normal
    if abs(distance - radii) > MALLET.farthest_rims or closing_speed < MALLET.least_closing_speed:
        return None
    if _comes_from_a_wall(place, after.velocity, geometry):
        return None
    by_noise = np.trace(before.covariance[:2, :2] + after.covariance[:2, :2]) / 8
    place_std = np.sqrt(by_noise + common_place_variance(before, after)) + path.noise
    return {
        "normal": normal, "t": t, "place": place, "velocity_before": before.velocity, "velocity_after": after.velocity,
        "mallet_velocity": velocity, "mallet_step": step @ normal, "mallet_covariance": _covariance(normal, covariance),
        "turning": float(velocity @ [normal[1], -normal[0]]) / distance,
        "mallet_acceleration": acceleration,
        "normal_std": place_std / radii, "spin_chain": motion.spin_chain, "cluster": motion.cluster,
        **velocity_errors(normal, before, after),
    }  # fmt: skip


def _comes_from_a_wall(place: np.ndarray, velocity: np.ndarray, geometry: Geometry) -> bool:
    """Whether a puck of this `velocity` after the contact may have met a wall since, so near to it is the `place`: then
    the motions before and after have both in between."""
    lines = nominal_lines(geometry)
    behind = [lines[f"{axis}{int(v < 0.0)}"] for axis, v in zip("xy", velocity, strict=True)]
    towards = np.abs(velocity) / MALLET.wall_keeps  # before the wall
    return bool((np.abs(place - behind) < towards * MALLET.longest_delay).any())


def _covariance(normal: np.ndarray, by_axis: np.ndarray) -> np.ndarray:
    """`mallet_covariance` (3, 3) from the covariances `by_axis` (2, 2, 2) of velocity and step along x and along y,
    whose encoder errors are independent."""
    axes = np.array([normal, [-normal[1], normal[0]]])
    covariance = np.zeros((3, 3))
    for axis in (0, 1):
        onto = np.array([[axes[0, axis], 0.0], [axes[1, axis], 0.0], [0.0, axes[0, axis]]])
        covariance += onto @ by_axis[axis] @ onto.T
    return covariance
