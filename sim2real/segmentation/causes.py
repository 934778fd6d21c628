"""Attribute a contact at a place and time to a wall, a goal post, the robot's mallet or the opponent's mallet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.recording.table_parameters import FROM_META, parameters
from sim2real.segmentation.tuned import SEGMENTATION

WALLS = ("x0", "x1", "y0", "y1")
POSTS = ("x0 right", "x0 left", "x1 right", "x1 left")
SIZES = ("length", "width", "goal_width", "puck_radius", "mallet_radius")


@dataclass(frozen=True)
class Geometry:
    """Nominal sizes [m]. `assumed`: names of the sizes that the recording does not state and that have defaults."""

    length: float
    width: float
    goal_width: float
    puck_radius: float
    mallet_radius: float
    assumed: frozenset[str] = frozenset()

    @property
    def goals_known(self) -> bool:
        """Whether the recording states the width of the goals."""
        return "goal_width" not in self.assumed

    def post(self, where: str) -> np.ndarray:
        """Place (2,) [m] of a goal post: "x0 right", "x1 left", …"""
        end, side = where.split()
        sign = 1 if side == "left" else -1
        return np.array([0.0 if end == "x0" else self.length, self.width / 2 + sign * self.goal_width / 2])


@dataclass(frozen=True)
class Track:
    """A mallet at the frames' times: place (frames, 2) [m], velocity (frames, 2) [m/s]; nan if it was not seen."""

    place: np.ndarray
    velocity: np.ndarray

    def at(self, t: np.ndarray, when: float) -> tuple[np.ndarray, np.ndarray]:
        """Place (2,) and velocity (2,) at the time `when` [s], extrapolated from the nearest frame of `t` (frames,)."""
        k = int(np.clip(np.searchsorted(t, when), 1, len(t) - 1))
        k -= when - t[k - 1] < t[k] - when
        return self.place[k] + self.velocity[k] * (when - t[k]), self.velocity[k]


def geometry(recording: Recording) -> Geometry:
    """Sizes from the recording's meta data; the simulator's defaults for those that it does not state."""
    sizes = parameters(recording)
    assumed = frozenset(name for name in SIZES if recording.nominal(*FROM_META[name]) is None)
    return Geometry(**{name: sizes[name] for name in SIZES}, assumed=assumed)


def mallet_tracks(recording: Recording, t: np.ndarray) -> dict[str, Track]:
    """The recorded mallets at the frames' times `t` (frames,) [s]: "robot" by its encoders, "opponent" by the camera.

    The accuracy suffices to attribute contacts; `mallet_path` gives the motion at a contact with its covariance.
    """
    streams = {"robot": (recording.mallet, "mallet"), "opponent": (recording.frames, "opponent")}
    found = {
        who: _track(stream.t, stream[f"{column}_x"], stream[f"{column}_y"], t)
        for who, (stream, column) in streams.items()
        if stream is not None
    }
    return {who: track for who, track in found.items() if track is not None}


def _track(clock: np.ndarray, x: np.ndarray, y: np.ndarray, t: np.ndarray) -> Track | None:
    """The track of a mallet with samples `x`, `y` (n,) at the times `clock` (n,); None for fewer than two samples."""
    seen = np.isfinite(x) & np.isfinite(y)
    if seen.sum() < 2:
        return None
    clock, x, y = clock[seen], x[seen], y[seen]
    near = np.clip(np.searchsorted(clock, t), 1, len(clock) - 1)
    span = SEGMENTATION.slope_span
    known = np.minimum(np.abs(clock[near] - t), np.abs(clock[near - 1] - t)) < 3 * span

    def place(at: np.ndarray) -> np.ndarray:
        both = np.stack([np.interp(at, clock, x), np.interp(at, clock, y)], axis=1)
        return np.where(known[:, None], both, np.nan)

    velocity = (place(t + span) - place(t - span)) / (2 * span)
    return Track(place(t), velocity)


def nominal_lines(g: Geometry) -> dict[str, float]:
    """Coordinate [m] of the puck's centre at contact with each wall, from the nominal sizes."""
    r = g.puck_radius
    return {"x0": r, "x1": g.length - r, "y0": r, "y1": g.width - r}


def measured_lines(g: Geometry, place: np.ndarray, v_in: np.ndarray, v_out: np.ndarray) -> dict[str, float]:
    """Estimate the walls' contact lines [m] from events at `place` (n, 2) [m] with velocities `v_in`, `v_out` (n, 2).

    A line is the median over the wall's clear contacts, which reverse the puck near the nominal line. The nominal line
    is used if there are too few of them.
    """
    lines = nominal_lines(g)
    for wall, line in lines.items():
        axis, _ = wall_axis(wall)
        near = np.abs(place[:, axis] - line) < SEGMENTATION.wall_search
        here = place[turned_round(wall, v_in, v_out) & near, axis]
        if len(here) >= SEGMENTATION.wall_contacts:
            lines[wall] = float(np.median(here))
    return lines


def wall_axis(wall: str) -> tuple[int, int]:
    """The axis (0: x, 1: y) and the sign of the inward normal of a wall."""
    return "xy".index(wall[0]), 1 if wall[1] == "0" else -1


def turned_round(wall: str, v_in: np.ndarray, v_out: np.ndarray) -> np.ndarray:
    """Whether velocities (…, 2) [m/s] before and after a contact clearly point to a wall and away from it, (…) bool."""
    axis, inward = wall_axis(wall)
    inwards, outwards = -SEGMENTATION.clearly_in, SEGMENTATION.clearly_out
    return (v_in[..., axis] * inward < inwards) & (v_out[..., axis] * inward > outwards)


def possible(g: Geometry, p: np.ndarray, tracks: dict[str, Track], noise: float) -> np.ndarray:
    """Whether (n,) bool the puck at `p` (n, 2) [m] is close enough to a wall or mallet for a contact.

    `noise` [m]: standard deviation of a coordinate.
    """
    reach = 3 * SEGMENTATION.place_slack + 6 * noise
    near = near_walls(nominal_lines(g), p, reach)
    return near | near_mallets(g, tracks, np.arange(len(p)), p, reach)


def near_walls(lines: dict[str, float], p: np.ndarray, reach: float) -> np.ndarray:
    """Whether (n,) bool a puck at the places `p` (n, 2) [m] is within `reach` [m] of a wall's contact line."""
    near = np.zeros(len(p), bool)
    for wall, line in lines.items():
        axis, inward = wall_axis(wall)
        near |= (p[:, axis] - line) * inward < reach
    return near


def near_posts(g: Geometry, p: np.ndarray, reach: float) -> np.ndarray:
    """Whether (n,) bool a puck at the places `p` (n, 2) [m] is within `reach` [m] of touching a goal post."""
    near = np.zeros(len(p), bool)
    for where in POSTS if g.goals_known else ():
        near |= np.linalg.norm(p - g.post(where), axis=1) < g.puck_radius + reach
    return near


def near_mallets(
    g: Geometry, tracks: Mapping[str, Track], index: np.ndarray, p: np.ndarray, reach: float
) -> np.ndarray:
    """Whether (n,) bool a mallet may touch the puck at places (n, 2) in the frames `index`, given its clock error."""
    near = np.zeros(len(p), bool)
    for track in tracks.values():
        distance = np.linalg.norm(p - track.place[index], axis=1) - g.puck_radius - g.mallet_radius
        speed = np.linalg.norm(track.velocity[index], axis=1)
        near |= distance < reach + SEGMENTATION.mallet_clock * np.nan_to_num(speed)
    return near


def touched_walls(
    lines: dict[str, float], g: Geometry, place: np.ndarray, v_in: np.ndarray, v_out: np.ndarray, slack: float
) -> list[str]:
    """Walls whose contact line is within `slack` [m] of `place` (2,) and that can change `v_in` to `v_out` (2,)."""
    found = []
    for wall, line in lines.items():
        axis, inward = wall_axis(wall)
        if abs(place[axis] - line) > slack or (v_out[axis] - v_in[axis]) * inward <= 0:
            continue
        leaves_before = v_in[axis] * inward > SEGMENTATION.touching
        if leaves_before or v_out[axis] * inward < -SEGMENTATION.touching or in_mouth(g, wall, place):
            continue
        found.append(wall)
    return found


def touched_post(g: Geometry, place: np.ndarray, dv: np.ndarray, slack: float) -> str:
    """The goal post ("x0 right", "x1 left", …) that the puck at `place` (2,) [m] touches; "" if none or unknown.

    `dv` (2,) [m/s]: the change of the puck's velocity; `slack` [m]: tolerance of the contact's place.
    """
    for where in POSTS if g.goals_known else ():
        away = place - g.post(where)
        distance = float(np.linalg.norm(away))
        if (
            in_mouth(g, where[:2], place, slack)
            and abs(distance - g.puck_radius) < slack
            and _pushed_along(away, distance, dv)
        ):
            return where
    return ""


def touched_mallet(
    g: Geometry,
    tracks: Mapping[str, Track],
    t: np.ndarray,
    when: float,
    place: np.ndarray,
    dv: np.ndarray,
    slack: float,
) -> tuple[str, np.ndarray, np.ndarray]:
    """The mallet that touched the puck at the time `when` [s]: its name ("" if none), velocity (2,), and normal (2,).

    `t` (frames,) [s]: the clock of the tracks; `place`, `dv`, `slack` as in `touched_post`.
    """
    for who, track in tracks.items():
        m, m_velocity = track.at(t, when)
        away = place - m
        distance = float(np.linalg.norm(away))
        gap = abs(distance - g.puck_radius - g.mallet_radius)
        by_clock = SEGMENTATION.mallet_clock * float(np.linalg.norm(m_velocity))
        allowed = min(SEGMENTATION.mallet_slack + slack + by_clock, SEGMENTATION.mallet_farthest)
        if gap < allowed and _pushed_along(away, distance, dv):
            return who, m_velocity, away / distance
    return "", np.full(2, np.nan), np.full(2, np.nan)


def _pushed_along(away: np.ndarray, distance: float, dv: np.ndarray) -> bool:
    """Whether the change of velocity `dv` (2,) is roughly along `away` (2,), a vector of length `distance`."""
    return bool(away @ dv > SEGMENTATION.along_normal * distance * np.linalg.norm(dv))


def may_be_goal(g: Geometry, wall: str, place: np.ndarray) -> bool:
    """Whether a contact with `wall` at `place` (2,) may be one with a goal post, as the goals' width is unknown."""
    reach = g.goal_width / 2 + SEGMENTATION.wider_goal / 2 + g.puck_radius
    return wall[0] == "x" and not g.goals_known and abs(place[1] - g.width / 2) < reach


def in_mouth(g: Geometry, wall: str, place: np.ndarray, slack: float = 0.0) -> bool:
    """Whether a puck at `place` (2,) is where `wall` is open for a goal of known width: it meets a post or nothing.

    `slack` [m]: tolerance of the place.
    """
    return wall[0] == "x" and g.goals_known and abs(place[1] - g.width / 2) < g.goal_width / 2 + slack
