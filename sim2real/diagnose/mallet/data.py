"""The blows of the robot's mallet as flat arrays, each in the frame of its line of centres."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim2real.diagnose.contact_data import Contacts, contacts_of, in_axes, shared_variance
from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.encoders import Encoders
from sim2real.diagnose.impacts import Impact

SLOWEST = 0.1  # m/s of closing; a slower touch is no clear blow
LONGEST_WAY = 0.012  # s between the hit and the moment at which the motions before and after meet
FARTHEST = 0.006  # m between the rims at a blow


@dataclass(frozen=True, kw_only=True)
class Blows(Contacts):
    """Contacts with the robot's mallet, `driven` (n, 2) [m/s] just before; the `step` (n,) [m/s] of its velocity along
    the normal. `swing` (n, 3, 3): covariance of both, in axes along the normal and the tangent."""

    driven: np.ndarray
    step: np.ndarray
    swing: np.ndarray

    @property
    def approach(self) -> np.ndarray:
        """Velocity (n, 2) [m/s] of the puck before, past the mallet."""
        return self.before - self.driven


def blows(impacts: Sequence[Impact], encoders: Encoders, g: Geometry) -> Blows:
    """The clear blows of the robot's mallet among the impacts of one recording, in order of time."""
    foreign = {impact.chain: impact.hit.t for impact in reversed(impacts) if impact.hit.where == "opponent"}
    rows = [
        {**row, "lost": impact.lost or impact.hit.t > foreign.get(impact.chain, np.inf)}
        for impact in impacts
        if (row := _row(impact, encoders, g)) is not None
    ]
    return contacts_of(Blows, rows, impacts, {"driven": (2,), "swing": (3, 3)})


def _row(impact: Impact, encoders: Encoders, g: Geometry) -> dict[str, Any] | None:
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
    swing = np.zeros((3, 3))
    for axis in (0, 1):  # the encoders' axes err apart from each other
        onto = np.array([[axes[0, axis], 0.0], [axes[1, axis], 0.0], [0.0, axes[0, axis]]])
        swing += onto @ covariance[axis] @ onto.T
    own = np.trace(before.covariance[:2, :2] + after.covariance[:2, :2]) / 8
    std = np.sqrt(own + shared_variance(before, after)) + encoders.noise
    return {
        "normal": normal, "t": t, "place": place, "before": before.velocity, "after": after.velocity, "driven": driven,
        "step": step @ normal, "swing": swing, "turn": std / touch, "chain": impact.chain, "cluster": impact.cluster,
        **in_axes(normal, before, after),
    }  # fmt: skip
