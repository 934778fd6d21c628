"""Breaks of the path as events, and events as hits: when, where, how fast before and after, and of what."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from sim2real.diagnose import contacts, kinks
from sim2real.diagnose.kinks import Side
from sim2real.diagnose.path import Path
from sim2real.diagnose.sensor import Noise

SIDE_FRAMES = 12  # beside a break, that tell the motion there
CLEAN_FRAMES = 5  # two more than a parabola has numbers


@dataclass(frozen=True)
class Hit:
    """A sudden change of velocity. `kind`: wall, post, mallet or unexplained.

    `where`: the wall ("x0", "y1"), the post ("x0 left"), the mallet ("robot", "opponent"), or what stands against an
    explanation. `v_in`, `v_out` (2,) [m/s] with `v_std` for each component; `frames`: the last valid frame before
    and the first after; `strength`: the change in standard deviations; `clean`: enough frames on both sides without
    another event. `normal` (2,) points to the puck; `mallet_v` (2,) is nan unless a mallet hit.
    """

    kind: str
    where: str
    t: float
    x: float
    y: float
    v_in: np.ndarray
    v_out: np.ndarray
    v_std: float
    frames: tuple[int, int]
    strength: float
    clean: bool
    normal: np.ndarray = field(default_factory=lambda: np.full(2, np.nan))
    mallet_v: np.ndarray = field(default_factory=lambda: np.full(2, np.nan))


@dataclass(frozen=True)
class Event:
    """A break at the gap `gap`: its time and place, and the motion on both sides at that time."""

    gap: int
    t: float
    place: np.ndarray
    left: Side
    right: Side
    strength: float


def find_events(path: Path, noise: Noise, strength: np.ndarray) -> list[Event]:
    """The breaks of a path, one at every gap of positive `strength` [standard deviations]; jumps only cut it."""
    cuts = np.flatnonzero(path.jumps | (strength > 0))
    events = []
    for k in np.flatnonzero(strength > 0):
        before, after = cuts[cuts < k], cuts[cuts > k]
        first = int(before[-1]) + 1 if len(before) else 0
        last = int(after[0]) + 1 if len(after) else len(path.t)
        left = slice(max(first, k + 1 - SIDE_FRAMES), k + 1)
        right = slice(k + 1, min(last, k + 1 + SIDE_FRAMES))
        events.append(_meet(path, noise, int(k), left, right, float(strength[k])))
    return events


def _meet(path: Path, noise: Noise, k: int, left: slice, right: slice, strength: float) -> Event:
    """Time and place at which the motions before and after the gap come nearest, at most half a gap outside of it."""
    slack = 0.5 * (path.t[k + 1] - path.t[k])
    when = (path.t[k] + path.t[k + 1]) / 2
    for _ in range(3):
        a = kinks.beside(path.t, path.p, when, left, noise)
        b = kinks.beside(path.t, path.p, when, right, noise)
        dv, apart = b.velocity - a.velocity, b.place - a.place
        step = -float(apart @ dv) / max(float(dv @ dv), 1e-12)
        moved = float(np.clip(when + step, path.t[k] - slack, path.t[k + 1] + slack))
        if abs(moved - when) < 1e-6:
            break
        when = moved
    weight = np.array([a.place_std, b.place_std]) ** -2.0
    place = (a.place * weight[0] + b.place * weight[1]) / weight.sum()
    return Event(k, when, place, a, b, strength)


def explain(event: Event, path: Path, g, lines, tracks) -> list[Hit]:
    """The event as hits: one; two in a corner; an unexplained one where nothing or more than one thing fits."""
    v_in, v_out = event.left.velocity, event.right.velocity
    dv = v_out - v_in
    spread = float(np.hypot(event.left.place_std, event.right.place_std))
    slack = contacts.NEAR + 4 * spread + 0.3 * float(np.diff(path.t)[event.gap] * np.linalg.norm(dv))
    walls = contacts.touched_walls(lines, g, event.place, v_in, v_out, slack)
    post = contacts.touched_post(g, event.place, dv, slack)
    who, mallet_v, normal = contacts.touched_mallet(g, tracks, path.t, event.t, event.place, dv, slack)
    post = "" if walls else post
    causes = len(walls) + bool(post) + bool(who)
    if len(walls) == 2 and causes == 2:
        return [_corner_hit(event, path, wall) for wall in walls]
    if causes > 1:
        return [_hit(event, path, "unexplained", " or ".join(filter(None, [*walls, post, who])), None)]
    if any(contacts.may_be_goal(g, wall, event.place) for wall in walls):
        return [_hit(event, path, "unexplained", f"{walls[0]} or a post", None)]
    if walls:
        return [_hit(event, path, "wall", walls[0], contacts.wall_axis(walls[0]))]
    if post:
        return [_hit(event, path, "post", post, None)]
    if who:
        return [_hit(event, path, "mallet", who, None, normal=normal, mallet_v=mallet_v)]
    return [_hit(event, path, "unexplained", "nothing near", None)]


def _corner_hit(event: Event, path: Path, wall: str) -> Hit:
    """One of two hits that no frames part: its time is that at which its own coordinate turns."""
    axis, _ = contacts.wall_axis(wall)
    apart = event.right.place[axis] - event.left.place[axis]
    turn = event.right.velocity[axis] - event.left.velocity[axis]
    reach = path.t[event.gap + 1] - path.t[event.gap]
    later = float(np.clip(-apart / turn, -reach, reach))
    return _hit(replace(event, t=event.t + later), path, "wall", wall, contacts.wall_axis(wall), clean=False)


def _hit(event: Event, path: Path, kind: str, where: str, wall, clean: bool = True, **more) -> Hit:
    if wall is not None:
        more["normal"] = np.eye(2)[wall[0]] * wall[1]
    v_std = float(np.hypot(event.left.velocity_std, event.right.velocity_std))
    clean = clean and min(event.left.frames, event.right.frames) >= CLEAN_FRAMES
    pair = (int(path.index[event.gap]), int(path.index[event.gap + 1]))
    x, y = (float(value) for value in event.place)
    v_in, v_out = event.left.velocity, event.right.velocity
    return Hit(kind, where, event.t, x, y, v_in, v_out, v_std, pair, event.strength, clean, **more)
