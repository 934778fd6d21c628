"""Cut a recording into pieces by physics: free glides, hits, and events that nothing on the table explains."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from itertools import pairwise

import numpy as np

from sim2real.diagnose import contacts, kinks
from sim2real.diagnose.kinks import Side
from sim2real.diagnose.sensor import Noise, estimate_noise, held_frames, wild_frames
from sim2real.recording import Recording

GLIDE_FRAMES = 8
LAUNCH_FRAMES = 5
SIDE_FRAMES = 12
CLEAN_FRAMES = 5
PUSHED = 0.4


@dataclass(frozen=True)
class Glide:
    """Free flight between events. `start`, `stop`: its frames are start … stop − 1 of the recording, of which `index`
    are valid; `t` (n,) [s], `x`, `y` (n,) [m] are those. Entry and exit are fitted at the first and last of them.
    """

    start: int
    stop: int
    index: np.ndarray
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    entry: Side
    exit: Side


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
class Pieces:
    """A recording cut up. `held`, `wild` (frames,) bool; `launches`: (start, stop) frames of unbroken motion;
    `lines`: where the puck's centre touched each wall [m]; `noise_std` [m] of a slow puck, `noise` with its clock.
    """

    noise: Noise
    held: np.ndarray
    wild: np.ndarray
    glides: tuple[Glide, ...]
    hits: tuple[Hit, ...]
    launches: tuple[tuple[int, int], ...]
    lines: dict[str, float]

    @property
    def noise_std(self) -> float:
        return self.noise.position

    def of_kind(self, kind: str) -> list[Hit]:
        """The hits of one kind, in the order of time."""
        return [hit for hit in self.hits if hit.kind == kind]


@dataclass(frozen=True)
class _Path:
    """The valid frames alone: their `index` in the recording, time, place, and the gaps that are jumps."""

    index: np.ndarray
    t: np.ndarray
    p: np.ndarray
    jumps: np.ndarray


def cut(recording: Recording) -> Pieces:
    """Cut `recording` into pieces. A recording without a puck has none."""
    g = contacts.geometry(recording)
    frames = recording.frames
    x = np.zeros(0) if frames is None else frames["puck_x"]
    y = np.zeros(0) if frames is None else frames["puck_y"]
    t = np.zeros(0) if frames is None else frames.t
    held, far = held_frames(x, y), recording.outside()
    noise, path, wild = _sense(t, np.stack([x, y], axis=1), held, far)
    if len(path.t) < GLIDE_FRAMES:
        return Pieces(noise, held, wild, (), (), (), contacts.nominal_lines(g))
    tracks = contacts.mallet_tracks(recording, path.t)
    expected = contacts.possible(g, path.p, tracks, noise.position)
    strength = kinks.find_kinks(path.t, path.p, noise, path.jumps, expected)
    events = _events(path, noise, strength)
    place = np.array([event.place for event in events]).reshape(-1, 2)
    v_in = np.array([event.left.velocity for event in events]).reshape(-1, 2)
    v_out = np.array([event.right.velocity for event in events]).reshape(-1, 2)
    lines = contacts.measured_lines(g, place, v_in, v_out)
    hits = [hit for event in events for hit in _explain(event, path, noise, g, lines, tracks)]
    glides, pushes = _glides(path, noise, strength > 0)
    hits = tuple(sorted((*hits, *pushes), key=lambda hit: hit.t))
    return Pieces(noise, held, wild, tuple(glides), hits, tuple(_launches(path)), lines)


def _sense(t: np.ndarray, p: np.ndarray, held: np.ndarray, far: np.ndarray) -> tuple[Noise, _Path, np.ndarray]:
    """Noise, the valid frames, and which frames (of all) are wild: far off the table, or off the path and back."""
    wild = far.copy()
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    noise = estimate_noise(t[index], p[index])
    wild[index[wild_frames(t[index], p[index], noise)]] = True
    for _ in range(3):
        index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
        jumps = kinks.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
        edges = np.concatenate([[0], np.flatnonzero(jumps) + 1, [len(index)]])
        short = [slice(a, b) for a, b in pairwise(edges) if 0 < b - a < LAUNCH_FRAMES]
        if not short:
            break
        for piece in short:
            wild[index[piece]] = True
    index = np.flatnonzero(np.isfinite(p).all(axis=1) & ~held & ~wild)
    jumps = kinks.find_jumps(t[index], p[index], noise) if len(index) > 1 else np.zeros(0, bool)
    return noise, _Path(index, t[index], p[index], jumps), wild


@dataclass(frozen=True)
class _Event:
    """A break at the gap `gap`: its time and place, and the motion on both sides at that time."""

    gap: int
    t: float
    place: np.ndarray
    left: Side
    right: Side
    strength: float


def _events(path: _Path, noise: Noise, strength: np.ndarray) -> list[_Event]:
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


def _meet(path: _Path, noise: Noise, k: int, left: slice, right: slice, strength: float) -> _Event:
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
    return _Event(k, when, place, a, b, strength)


def _explain(event: _Event, path: _Path, noise: Noise, g, lines, tracks) -> list[Hit]:
    """The event as hits: one; two in a corner; an unexplained one where nothing or more than one thing fits."""
    v_in, v_out = event.left.velocity, event.right.velocity
    dv = v_out - v_in
    spread = float(np.hypot(event.left.place_std, event.right.place_std))
    slack = contacts.NEAR + 4 * spread + 0.3 * float(np.diff(path.t)[event.gap] * np.linalg.norm(dv))
    walls = contacts.touched_walls(lines, g, event.place, v_in, v_out, slack)
    post = contacts.touched_post(g, event.place, dv, slack)
    who, mallet_v, normal = contacts.touched_mallet(g, tracks, path.t, event.t, event.place, v_in, dv, slack)
    post = "" if walls else post
    causes = len(walls) + bool(post) + bool(who)
    if len(walls) == 2 and causes == 2:
        return [_corner_hit(event, path, wall) for wall in walls]
    if causes > 1:
        return [_hit(event, path, "unexplained", " or ".join(filter(None, [*walls, post, who])), None)]
    if walls:
        return [_hit(event, path, "wall", walls[0], contacts.wall_axis(walls[0]))]
    if post:
        return [_hit(event, path, "post", post, None)]
    if who:
        return [_hit(event, path, "mallet", who, None, normal=normal, mallet_v=mallet_v)]
    return [_hit(event, path, "unexplained", "nothing near", None)]


def _corner_hit(event: _Event, path: _Path, wall: str) -> Hit:
    """One of two hits that no frames part: its time is that at which its own coordinate turns."""
    axis, _ = contacts.wall_axis(wall)
    apart = event.right.place[axis] - event.left.place[axis]
    turn = event.right.velocity[axis] - event.left.velocity[axis]
    reach = path.t[event.gap + 1] - path.t[event.gap]
    later = float(np.clip(-apart / turn, -reach, reach))
    return _hit(replace(event, t=event.t + later), path, "wall", wall, contacts.wall_axis(wall), clean=False)


def _hit(event: _Event, path: _Path, kind: str, where: str, wall, clean: bool = True, **more) -> Hit:
    if wall is not None:
        more["normal"] = np.eye(2)[wall[0]] * wall[1]
    v_std = float(np.hypot(event.left.velocity_std, event.right.velocity_std))
    clean = clean and min(event.left.frames, event.right.frames) >= CLEAN_FRAMES
    pair = (int(path.index[event.gap]), int(path.index[event.gap + 1]))
    x, y = (float(value) for value in event.place)
    v_in, v_out = event.left.velocity, event.right.velocity
    return Hit(kind, where, event.t, x, y, v_in, v_out, v_std, pair, event.strength, clean, **more)


def _glides(path: _Path, noise: Noise, broken: np.ndarray) -> tuple[list[Glide], list[Hit]]:
    """Stretches between events that are long enough; those that gain too much speed were pushed: unexplained."""
    edges = np.concatenate([[0], np.flatnonzero(path.jumps | broken) + 1, [len(path.t)]])
    glides, pushes = [], []
    for a, b in pairwise(edges):
        if b - a < GLIDE_FRAMES:
            continue
        t, p = path.t[a:b], path.p[a:b]
        entry = kinks.beside(path.t, path.p, t[0], slice(a, min(b, a + 2 * SIDE_FRAMES)), noise)
        last = kinks.beside(path.t, path.p, t[-1], slice(max(a, b - 2 * SIDE_FRAMES), b), noise)
        gained = float(np.linalg.norm(last.velocity) - np.linalg.norm(entry.velocity))
        sure = 4 * float(np.hypot(entry.velocity_std, last.velocity_std))
        start, stop = int(path.index[a]), int(path.index[b - 1]) + 1
        if gained - sure > PUSHED * (t[-1] - t[0]):
            v, std = (entry.velocity, last.velocity), sure / 4
            pushes.append(Hit("unexplained", "pushed", t[0], *p[0], *v, std, (start, stop - 1), 0.0, False))
            continue
        glides.append(Glide(start, stop, path.index[a:b], t, p[:, 0], p[:, 1], entry, last))
    return glides, pushes


def _launches(path: _Path) -> list[tuple[int, int]]:
    edges = np.concatenate([[0], np.flatnonzero(path.jumps) + 1, [len(path.t)]])
    pairs = pairwise(edges)
    return [(int(path.index[a]), int(path.index[b - 1]) + 1) for a, b in pairs if b - a >= LAUNCH_FRAMES]
