"""The bounces of a recording off walls and posts as flat arrays, in the frame of each wall."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from puckpilot_env.physics import bounce
from sim2real.diagnose.contact_data import Contacts, contacts_of, in_axes, kept, shared_variance
from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.impacts import Impact, Side

KINDS = {"x0": bounce.WALL_X0, "x1": bounce.WALL_X1, "y0": bounce.WALL_Y0, "y1": bounce.WALL_Y1}
SLOWEST = 0.05  # m/s along the normal; a slower touch is no clear bounce
LATE = 0.02  # s, by which the time of a hit may be wrong
FEWEST = 3  # bounces of a wall that has a usual restitution of its own
UNUSUAL = 0.3  # difference of a restitution from the usual one that no wall makes
STRAY = 12.0  # standard deviations of a jump in place across a bounce that is none


@dataclass(frozen=True, kw_only=True)
class Bounces(Contacts):
    """Contacts with walls and posts, of `kind` (n,) as in `bounce`; `since` (n,) [s] after the contact before."""

    kind: np.ndarray
    since: np.ndarray


def bounces(impacts: list[Impact], g: Geometry, known: Bounces | None = None) -> Bounces:
    """The clear bounces off walls and posts among `impacts`, in order of time. What is usual is asked of the bounces
    `known`, if there are any, and else of these themselves."""
    rows = {k: row for k, impact in enumerate(impacts) if (row := _row(impact, g)) is not None}
    every = contacts_of(Bounces, list(rows.values()), impacts, {})
    usual = are_usual(every, known if known is not None and len(known) else every)
    number = np.array(list(rows), int)[usual]
    return chained(kept(every, usual), number, np.array([impact.chain for impact in impacts], int))


def are_usual(every: Bounces, known: Bounces) -> np.ndarray:
    """Which bounces (n,) are no hits at a wall of a restitution quite unusual for it: there something else was hit as
    well. A wall that was hit a few times among those `known` has a usual restitution of its own."""
    restitution, told = (some.split(some.after)[:, 0] / some.closing for some in (every, known))
    wall, known_wall, usual = every.kind != bounce.POST, known.kind != bounce.POST, np.zeros(len(every))
    for kind in np.unique(every.kind[wall]):
        own = known.kind == kind
        own = own if own.sum() >= FEWEST else known_wall
        usual[every.kind == kind] = np.median(told[own]) if own.any() else np.median(restitution[wall])
    return ~wall | (np.abs(restitution - usual) < UNUSUAL)


def chained(some: Bounces, number: np.ndarray, chains: np.ndarray) -> Bounces:
    """Bounces, of this `number` (n,) among impacts of these `chains` (m,), with chains that end where an impact of
    theirs is not among them: what spin the puck has after it, nobody knows."""
    link, lost = np.arange(len(some)), some.lost.copy()
    for i, k in enumerate(number):
        within = k > 0 and chains[k] == chains[k - 1]
        if within and i > 0 and number[i - 1] == k - 1:
            link[i], lost[i] = link[i - 1], lost[i - 1]
        else:
            lost[i] |= within
    return replace(some, chain=link, lost=lost)


def _row(impact: Impact, g: Geometry) -> dict[str, Any] | None:
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
        turn = float(np.sqrt(np.trace(sure) / 2 + shared_variance(before, after))) / g.puck_radius
        kind = bounce.POST
    elif hit.kind == "wall" and _meets(before, after):
        kind, normal, turn = KINDS[hit.where], hit.normal, 0.0
    else:
        return None
    if -(before.velocity @ normal) < SLOWEST:
        return None
    return {
        "kind": kind, "normal": normal, "t": hit.t, "place": place, "before": before.velocity, "after": after.velocity,
        "turn": turn, "chain": impact.chain, "lost": impact.lost, "since": impact.since, "cluster": impact.cluster,
        **in_axes(normal, before, after),
    }  # fmt: skip


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
