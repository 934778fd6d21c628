"""What a puck can have touched at a place and time: walls, goal posts, the robot's or the opponent's mallet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from puckpilot_env.parameters import TABLE
from sim2real.recording import Recording

WALLS = ("x0", "x1", "y0", "y1")
NEAR = 0.006
LINE_SEARCH = 0.03
MALLET_NEAR = 0.008
MALLET_CLOCK = 0.03
MALLET_FARTHEST = 0.07
SLOPE_SPAN = 0.012


@dataclass(frozen=True)
class Geometry:
    """Nominal sizes [m]. `goal_width` is None where the recording does not say it."""

    length: float
    width: float
    goal_width: float | None
    puck_radius: float
    mallet_radius: float


@dataclass(frozen=True)
class Track:
    """A mallet at the frames' times: place (frames, 2) and velocity (frames, 2); nan where it was not seen."""

    place: np.ndarray
    velocity: np.ndarray

    def at(self, t: np.ndarray, when: float) -> tuple[np.ndarray, np.ndarray]:
        """Place (2,) and velocity (2,) at the time `when`, from the nearer frame of the clock `t`."""
        k = int(np.clip(np.searchsorted(t, when), 1, len(t) - 1))
        k -= when - t[k - 1] < t[k] - when
        return self.place[k] + self.velocity[k] * (when - t[k]), self.velocity[k]


def geometry(recording: Recording) -> Geometry:
    """Sizes from the recording's meta data, the table of parameters' defaults where these are unknown."""
    default = {row.name: row.default for row in TABLE}

    def size(section: str, key: str, name: str) -> float:
        value = recording.nominal(section, key)
        return default[name] if value is None else value

    return Geometry(
        size("table", "length_m", "length"),
        size("table", "width_m", "width"),
        recording.nominal("table", "goal_width_m"),
        size("puck", "radius_m", "puck_radius"),
        size("mallet", "radius_m", "mallet_radius"),
    )


def mallet_tracks(recording: Recording, t: np.ndarray) -> dict[str, Track]:
    """The mallets that were recorded, at the frames' times `t`: "robot" from its encoders, "opponent" from vision."""
    tracks = {}
    if recording.mallet is not None and recording.mallet.rows > 1:
        stream = recording.mallet
        tracks["robot"] = _track(stream.t, stream["mallet_x"], stream["mallet_y"], t)
    if recording.frames is not None:
        stream = recording.frames
        if np.isfinite(stream["opponent_x"]).sum() > 1:
            tracks["opponent"] = _track(stream.t, stream["opponent_x"], stream["opponent_y"], t)
    return tracks


def _track(clock: np.ndarray, x: np.ndarray, y: np.ndarray, t: np.ndarray) -> Track:
    seen = np.isfinite(x) & np.isfinite(y)
    clock, x, y = clock[seen], x[seen], y[seen]
    near = np.clip(np.searchsorted(clock, t), 1, len(clock) - 1)
    known = np.minimum(np.abs(clock[near] - t), np.abs(clock[near - 1] - t)) < 3 * SLOPE_SPAN

    def place(at: np.ndarray) -> np.ndarray:
        both = np.stack([np.interp(at, clock, x), np.interp(at, clock, y)], axis=1)
        return np.where(known[:, None], both, np.nan)

    velocity = (place(t + SLOPE_SPAN) - place(t - SLOPE_SPAN)) / (2 * SLOPE_SPAN)
    return Track(place(t), velocity)


def nominal_lines(g: Geometry) -> dict[str, float]:
    """Where the puck's centre is when it touches each wall [m]."""
    r = g.puck_radius
    return {"x0": r, "x1": g.length - r, "y0": r, "y1": g.width - r}


def measured_lines(g: Geometry, place: np.ndarray, v_in: np.ndarray, v_out: np.ndarray) -> dict[str, float]:
    """The walls' contact lines [m] as the events (n, 2) show them; nominal where fewer than 5 clear hits tell.

    A clear hit turns round a normal component of at least 0.1 m/s within LINE_SEARCH of the nominal line.
    """
    lines = nominal_lines(g)
    for wall, line in lines.items():
        axis, inward = wall_axis(wall)
        turned = (v_in[:, axis] * inward < -0.1) & (v_out[:, axis] * inward > 0.05)
        here = place[turned & (np.abs(place[:, axis] - line) < LINE_SEARCH), axis]
        if len(here) >= 5:
            lines[wall] = float(np.median(here))
    return lines


def wall_axis(wall: str) -> tuple[int, int]:
    """The axis (0 is x, 1 is y) and the sign of the inward normal of a wall."""
    return "xy".index(wall[0]), 1 if wall[1] == "0" else -1


def possible(g: Geometry, p: np.ndarray, tracks: dict[str, Track], noise: float) -> np.ndarray:
    """Frames (n,) bool at which the puck is so near to a wall, post or mallet that a contact may be."""
    reach = 3 * NEAR + 6 * noise
    near = near_walls(nominal_lines(g), p, reach)
    return near | near_mallets(g, tracks, np.arange(len(p)), p, reach)


def near_walls(lines: dict[str, float], p: np.ndarray, reach: float) -> np.ndarray:
    """Places (n, 2) at which the puck is within `reach` [m] of a wall's contact line, shape (n,) bool."""
    near = np.zeros(len(p), bool)
    for wall, line in lines.items():
        axis, inward = wall_axis(wall)
        near |= (p[:, axis] - line) * inward < reach
    return near


def near_posts(g: Geometry, p: np.ndarray, reach: float) -> np.ndarray:
    """Places (n, 2) at which the puck is within `reach` [m] of touching a goal post, shape (n,) bool."""
    near = np.zeros(len(p), bool)
    if g.goal_width is None:
        return near
    for x in (0.0, g.length):
        for sign in (-1, 1):
            away = p - np.array([x, g.width / 2 + sign * g.goal_width / 2])
            near |= np.linalg.norm(away, axis=1) < g.puck_radius + reach
    return near


def near_mallets(
    g: Geometry, tracks: Mapping[str, Track], index: np.ndarray, p: np.ndarray, reach: float
) -> np.ndarray:
    """Places (n, 2) at the frames `index` at which a mallet may touch the puck, allowing for its clock; (n,) bool."""
    near = np.zeros(len(p), bool)
    for track in tracks.values():
        distance = np.linalg.norm(p - track.place[index], axis=1) - g.puck_radius - g.mallet_radius
        speed = np.linalg.norm(track.velocity[index], axis=1)
        near |= distance < reach + MALLET_CLOCK * np.nan_to_num(speed)
    return near


def touched_walls(lines, g: Geometry, place, v_in, v_out, slack: float) -> list[str]:
    """Walls whose contact line `place` (2,) is on (within `slack`) and that turn v_in into v_out."""
    found = []
    for wall, line in lines.items():
        axis, inward = wall_axis(wall)
        if abs(place[axis] - line) > slack or (v_out[axis] - v_in[axis]) * inward <= 0:
            continue
        if v_in[axis] * inward > 0.02 or v_out[axis] * inward < -0.02 or _in_mouth(g, wall, place):
            continue
        found.append(wall)
    return found


def touched_post(g: Geometry, place: np.ndarray, dv: np.ndarray, slack: float) -> str:
    """The goal post ("x0 right", "x1 left", ...) that the puck at `place` touches; "" if none or goals unknown."""
    if g.goal_width is None:
        return ""
    for end, x in (("x0", 0.0), ("x1", g.length)):
        for side, sign in (("right", -1), ("left", 1)):
            post = np.array([x, g.width / 2 + sign * g.goal_width / 2])
            away = place - post
            distance = float(np.linalg.norm(away))
            in_mouth = (post[1] - place[1]) * sign > -slack
            if in_mouth and abs(distance - g.puck_radius) < slack and away @ dv > 0.5 * distance * np.linalg.norm(dv):
                return f"{end} {side}"
    return ""


def touched_mallet(g, tracks, t, when, place, v_in, dv, slack: float) -> tuple[str, np.ndarray, np.ndarray]:
    """The mallet that pushed the puck at the time `when`: its name ("" if none), its velocity (2,), the normal (2,)."""
    for who, track in tracks.items():
        m, m_velocity = track.at(t, when)
        away = place - m
        distance = float(np.linalg.norm(away))
        gap = abs(distance - g.puck_radius - g.mallet_radius)
        allowed = min(MALLET_NEAR + slack + MALLET_CLOCK * float(np.linalg.norm(m_velocity)), MALLET_FARTHEST)
        if gap < allowed and away @ dv > 0.5 * distance * np.linalg.norm(dv):
            return who, m_velocity, away / distance
    return "", np.full(2, np.nan), np.full(2, np.nan)


def _in_mouth(g: Geometry, wall: str, place: np.ndarray) -> bool:
    if wall[0] == "y" or g.goal_width is None:
        return False
    return abs(place[1] - g.width / 2) < g.goal_width / 2
