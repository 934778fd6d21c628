"""What a puck can have touched at a place and time: walls, goal posts, the robot's or the opponent's mallet."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from sim2real.nominal import FROM_META, parameters
from sim2real.recording import Recording

WALLS = ("x0", "x1", "y0", "y1")
POSTS = ("x0 right", "x0 left", "x1 right", "x1 left")
NEAR = 0.006  # m, by which a contact may be off its place beside all noise
LINE_SEARCH = 0.03  # m, from a wall's nominal line, within which its true one is looked for
MALLET_NEAR = 0.008  # m, the same of a mallet
MALLET_CLOCK = 0.03  # s, by which a mallet's clock may be off the camera's
MALLET_FARTHEST = 0.07  # m, to which all this may add up however fast the mallet is
CLEARLY_IN, CLEARLY_OUT = 0.1, 0.05  # m/s along the normal; a slower touch may be noise or a slide
SLOPE_SPAN = 0.012  # s on either side, over which a mallet's velocity is a difference of places
WIDER = 0.06  # m, by which a goal of unknown width may be wider than the simulator's
SIZES = ("length", "width", "goal_width", "puck_radius", "mallet_radius")


@dataclass(frozen=True)
class Geometry:
    """Nominal sizes [m]. `assumed`: the names of those that the recording does not state, the simulator's own."""

    length: float
    width: float
    goal_width: float
    puck_radius: float
    mallet_radius: float
    assumed: frozenset[str] = frozenset()

    @property
    def goals_known(self) -> bool:
        return "goal_width" not in self.assumed

    def post(self, where: str) -> np.ndarray:
        """Place (2,) of a goal post: "x0 right", "x1 left", …"""
        end, side = where.split()
        sign = 1 if side == "left" else -1
        return np.array([0.0 if end == "x0" else self.length, self.width / 2 + sign * self.goal_width / 2])


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
    """Sizes from the recording's meta data, the simulator's own where these are unknown."""
    sizes = parameters(recording)
    assumed = frozenset(name for name in SIZES if recording.nominal(*FROM_META[name]) is None)
    return Geometry(**{name: sizes[name] for name in SIZES}, assumed=assumed)


def mallet_tracks(recording: Recording, t: np.ndarray) -> dict[str, Track]:
    """The mallets that were recorded, at the frames' times `t`: "robot" from its encoders, "opponent" from vision."""
    streams = {"robot": (recording.mallet, "mallet"), "opponent": (recording.frames, "opponent")}
    found = {
        who: _track(stream.t, stream[f"{column}_x"], stream[f"{column}_y"], t)
        for who, (stream, column) in streams.items()
        if stream is not None
    }
    return {who: track for who, track in found.items() if track is not None}


def _track(clock: np.ndarray, x: np.ndarray, y: np.ndarray, t: np.ndarray) -> Track | None:
    """The mallet seen at (x, y) (n,) at the times `clock` (n,); None where it was seen once at most."""
    seen = np.isfinite(x) & np.isfinite(y)
    if seen.sum() < 2:
        return None
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

    A clear hit turns the puck round within LINE_SEARCH of the nominal line.
    """
    lines = nominal_lines(g)
    for wall, line in lines.items():
        axis, _ = wall_axis(wall)
        here = place[turned_round(wall, v_in, v_out) & (np.abs(place[:, axis] - line) < LINE_SEARCH), axis]
        if len(here) >= 5:
            lines[wall] = float(np.median(here))
    return lines


def wall_axis(wall: str) -> tuple[int, int]:
    """The axis (0 is x, 1 is y) and the sign of the inward normal of a wall."""
    return "xy".index(wall[0]), 1 if wall[1] == "0" else -1


def turned_round(wall: str, v_in: np.ndarray, v_out: np.ndarray) -> np.ndarray:
    """Whether velocities (…, 2) [m/s] before and after a hit clearly go towards a wall and away from it, (…) bool."""
    axis, inward = wall_axis(wall)
    return (v_in[..., axis] * inward < -CLEARLY_IN) & (v_out[..., axis] * inward > CLEARLY_OUT)


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
    for where in POSTS if g.goals_known else ():
        near |= np.linalg.norm(p - g.post(where), axis=1) < g.puck_radius + reach
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
    for where in POSTS if g.goals_known else ():
        away = place - g.post(where)
        distance = float(np.linalg.norm(away))
        in_mouth = abs(place[1] - g.width / 2) < g.goal_width / 2 + slack
        if in_mouth and abs(distance - g.puck_radius) < slack and away @ dv > 0.5 * distance * np.linalg.norm(dv):
            return where
    return ""


def touched_mallet(g, tracks, t, when, place, dv, slack: float) -> tuple[str, np.ndarray, np.ndarray]:
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


def may_be_goal(g: Geometry, wall: str, place: np.ndarray) -> bool:
    """Whether what looks like a touch of `wall` may be one of a goal post, as nobody said how wide the goals are."""
    reach = g.goal_width / 2 + WIDER / 2 + g.puck_radius
    return wall[0] == "x" and not g.goals_known and abs(place[1] - g.width / 2) < reach


def _in_mouth(g: Geometry, wall: str, place: np.ndarray) -> bool:
    return wall[0] == "x" and g.goals_known and abs(place[1] - g.width / 2) < g.goal_width / 2
