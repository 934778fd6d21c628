"""Cut a recording into pieces by physics: free glides, hits, and events that nothing on the table explains."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim2real.diagnose import contacts, kinks
from sim2real.diagnose.hits import Hit, explain, find_events
from sim2real.diagnose.kinks import Side
from sim2real.diagnose.path import LAUNCH_FRAMES, Path, sense
from sim2real.diagnose.sensor import Noise, held_frames
from sim2real.recording import Recording

GLIDE_FRAMES = 8  # a shorter stretch is no glide
ENDS_FRAMES = 24  # of a glide, that tell its velocity at an end
PUSHED = 0.4  # m/s^2, more than which no free puck gains


@dataclass(frozen=True)
class Glide:
    """Free flight between events. `start`, `stop`: its frames are start … stop − 1 of the recording, of which `index`
    are valid; `t` (n,) [s], `x`, `y` (n,) [m] are those. The entry is fitted at the first of them.
    """

    start: int
    stop: int
    index: np.ndarray
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    entry: Side


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


def cut(recording: Recording) -> Pieces:
    """Cut `recording` into pieces. A recording without a puck has none."""
    g = contacts.geometry(recording)
    frames = recording.frames
    x = np.zeros(0) if frames is None else frames["puck_x"]
    y = np.zeros(0) if frames is None else frames["puck_y"]
    t = np.zeros(0) if frames is None else frames.t
    held, far = held_frames(x, y), recording.outside()
    noise, path, wild = sense(t, np.stack([x, y], axis=1), held, far)
    if len(path.t) < GLIDE_FRAMES:
        return Pieces(noise, held, wild, (), (), (), contacts.nominal_lines(g))
    tracks = contacts.mallet_tracks(recording, path.t)
    expected = contacts.possible(g, path.p, tracks, noise.position)
    strength = kinks.find_kinks(path.t, path.p, noise, path.jumps, expected)
    events = find_events(path, noise, strength)
    place = np.array([event.place for event in events]).reshape(-1, 2)
    v_in = np.array([event.left.velocity for event in events]).reshape(-1, 2)
    v_out = np.array([event.right.velocity for event in events]).reshape(-1, 2)
    lines = contacts.measured_lines(g, place, v_in, v_out)
    hits = [hit for event in events for hit in explain(event, path, g, lines, tracks)]
    glides, pushes = _glides(path, noise, strength > 0)
    hits = tuple(sorted((*hits, *pushes), key=lambda hit: hit.t))
    return Pieces(noise, held, wild, tuple(glides), hits, tuple(_launches(path)), lines)


def _glides(path: Path, noise: Noise, broken: np.ndarray) -> tuple[list[Glide], list[Hit]]:
    """Stretches between events that are long enough; those that gain too much speed were pushed: unexplained."""
    edges = np.concatenate([[0], np.flatnonzero(path.jumps | broken) + 1, [len(path.t)]])
    glides, pushes = [], []
    for a, b in pairwise(edges):
        if b - a < GLIDE_FRAMES:
            continue
        t, p = path.t[a:b], path.p[a:b]
        entry = kinks.beside(path.t, path.p, t[0], slice(a, min(b, a + ENDS_FRAMES)), noise)
        last = kinks.beside(path.t, path.p, t[-1], slice(max(a, b - ENDS_FRAMES), b), noise)
        gained = float(np.linalg.norm(last.velocity) - np.linalg.norm(entry.velocity))
        sure = 4 * float(np.hypot(entry.velocity_std, last.velocity_std))
        start, stop = int(path.index[a]), int(path.index[b - 1]) + 1
        if gained - sure > PUSHED * (t[-1] - t[0]):
            v, std = (entry.velocity, last.velocity), sure / 4
            pushes.append(_push(t[0], p[0], v, std, (start, stop - 1)))
            continue
        glides.append(Glide(start, stop, path.index[a:b], t, p[:, 0], p[:, 1], entry))
    return glides, pushes


def _push(t: float, place: np.ndarray, v: tuple[np.ndarray, np.ndarray], v_std: float, frames: tuple[int, int]) -> Hit:
    x, y = float(place[0]), float(place[1])
    return Hit("unexplained", "pushed", float(t), x, y, v[0], v[1], v_std, frames, 0.0, False)


def _launches(path: Path) -> list[tuple[int, int]]:
    edges = np.concatenate([[0], np.flatnonzero(path.jumps) + 1, [len(path.t)]])
    pairs = pairwise(edges)
    return [(int(path.index[a]), int(path.index[b - 1]) + 1) for a, b in pairs if b - a >= LAUNCH_FRAMES]
