"""Convert changepoints to events, and events to contacts with time, place, velocities before and after, and cause."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np

from sim2real.segmentation import causes
from sim2real.segmentation.causes import Geometry, Track
from sim2real.segmentation.local_motion import LocalMotion, local_motion
from sim2real.segmentation.sensor_noise import Noise
from sim2real.segmentation.tuned import SEGMENTATION
from sim2real.segmentation.valid_path import Path


@dataclass(frozen=True)
class ContactEvent:
    """A sudden change of velocity. `kind`: wall, post, mallet or unexplained.

    `where`: the wall ("x0", "y1"), the post ("x0 left"), the mallet ("robot", "opponent"), or why it is unexplained.
    `t` [s] on the camera's clock; `x`, `y` [m]; `v_in`, `v_out` (2,) [m/s]: the velocities before and after, with the
    standard deviation `v_std` of each component; `frames`: the last valid frame before and the first after;
    `strength`: the change in standard deviations; `clean`: enough frames on both sides without another event.
    `normal` (2,) points to the puck; `mallet_v` (2,) [m/s] is nan unless a mallet touched the puck.
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
    """A changepoint at the gap `gap`: its time [s] and place (2,) [m], and the motion on both sides at that time."""

    gap: int
    t: float
    place: np.ndarray
    left: LocalMotion
    right: LocalMotion
    strength: float


def find_events(path: Path, noise: Noise, strength: np.ndarray) -> list[Event]:
    """The events of a path, one at each gap of positive `strength` (gaps,) [standard deviations] that is no jump."""
    cuts = np.flatnonzero(path.jumps | (strength > 0))
    events = []
    for k in np.flatnonzero(strength > 0):
        before, after = cuts[cuts < k], cuts[cuts > k]
        first = int(before[-1]) + 1 if len(before) else 0
        last = int(after[0]) + 1 if len(after) else len(path.t)
        left = slice(max(first, k + 1 - SEGMENTATION.side_frames), k + 1)
        right = slice(k + 1, min(last, k + 1 + SEGMENTATION.side_frames))
        events.append(_meet(path, noise, int(k), left, right, float(strength[k])))
    return events


def _meet(path: Path, noise: Noise, k: int, left: slice, right: slice, strength: float) -> Event:
    """The event where the motions before and after the gap are closest, at most half a gap outside of it."""
    slack = 0.5 * (path.t[k + 1] - path.t[k])
    when = (path.t[k] + path.t[k + 1]) / 2
    for _ in range(3):
        a = local_motion(path.t, path.p, when, left, noise)
        b = local_motion(path.t, path.p, when, right, noise)
        dv, miss = b.velocity - a.velocity, b.place - a.place
        step = -float(miss @ dv) / max(float(dv @ dv), 1e-12)
        moved = float(np.clip(when + step, path.t[k] - slack, path.t[k + 1] + slack))
        if abs(moved - when) < 1e-6:
            break
        when = moved
    weight = np.array([a.place_std, b.place_std]) ** -2.0
    place = (a.place * weight[0] + b.place * weight[1]) / weight.sum()
    return Event(k, when, place, a, b, strength)


def attribute(
    event: Event, path: Path, g: Geometry, lines: dict[str, float], tracks: Mapping[str, Track]
) -> list[ContactEvent]:
    """Attribute an event to contacts: one; two in a corner; an unexplained one if no cause or several causes fit.

    `lines`: the walls' contact lines [m]; `tracks`: the recorded mallets at the path's times.
    """
    v_in, v_out = event.left.velocity, event.right.velocity
    dv = v_out - v_in
    spread = float(np.hypot(event.left.place_std, event.right.place_std))
    within_gap = SEGMENTATION.gap_share * float(np.diff(path.t)[event.gap] * np.linalg.norm(dv))
    slack = SEGMENTATION.place_slack + 4 * spread + within_gap
    walls = causes.touched_walls(lines, g, event.place, v_in, v_out, slack)
    post = causes.touched_post(g, event.place, dv, slack)
    who, mallet_v, normal = causes.touched_mallet(g, tracks, path.t, event.t, event.place, dv, slack)
    post = "" if walls else post
    fitting = len(walls) + bool(post) + bool(who)
    if len(walls) == 2 and fitting == 2:
        return [_corner_contact(event, path, wall) for wall in walls]
    if fitting > 1:
        several = " or ".join(one for one in (*walls, post, who) if one)
        return [_contact(event, path, "unexplained", several, None)]
    if any(causes.may_be_goal(g, wall, event.place) for wall in walls):
        return [_contact(event, path, "unexplained", f"{walls[0]} or a post", None)]
    if walls:
        return [_contact(event, path, "wall", walls[0], causes.wall_axis(walls[0]))]
    if post:
        return [_contact(event, path, "post", post, None)]
    if who:
        return [_contact(event, path, "mallet", who, None, normal=normal, mallet_v=mallet_v)]
    return [_contact(event, path, "unexplained", "nothing near", None)]


def _corner_contact(event: Event, path: Path, wall: str) -> ContactEvent:
    """One of two contacts without a frame between them; its time is that at which its coordinate reverses."""
    axis, _ = causes.wall_axis(wall)
    miss = event.right.place[axis] - event.left.place[axis]
    turn = event.right.velocity[axis] - event.left.velocity[axis]
    reach = path.t[event.gap + 1] - path.t[event.gap]
    later = float(np.clip(-miss / turn, -reach, reach))
    return _contact(replace(event, t=event.t + later), path, "wall", wall, causes.wall_axis(wall), clean=False)


def _contact(
    event: Event,
    path: Path,
    kind: str,
    where: str,
    wall: tuple[int, int] | None,
    clean: bool = True,
    **more: np.ndarray,
) -> ContactEvent:
    if wall is not None:
        more["normal"] = np.eye(2)[wall[0]] * wall[1]
    v_std = float(np.hypot(event.left.velocity_std, event.right.velocity_std))
    clean = clean and min(event.left.frames, event.right.frames) >= SEGMENTATION.clean_frames
    pair = (int(path.index[event.gap]), int(path.index[event.gap + 1]))
    x, y = (float(value) for value in event.place)
    v_in, v_out = event.left.velocity, event.right.velocity
    return ContactEvent(kind, where, event.t, x, y, v_in, v_out, v_std, pair, event.strength, clean, **more)
