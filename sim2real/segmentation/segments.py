"""Cut a recording into segments: free glides, contacts, and unexplained events."""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.segmentation import causes, changepoints
from sim2real.segmentation.events import ContactEvent, attribute, find_events
from sim2real.segmentation.let_go import let_go
from sim2real.segmentation.local_motion import LocalMotion, local_motion
from sim2real.segmentation.sensor_noise import Noise, held_frames
from sim2real.segmentation.tuned import SEGMENTATION
from sim2real.segmentation.valid_path import Path, valid_path


@dataclass(frozen=True)
class Glide:
    """Free motion between events, in the frames `start` … `stop` − 1 of the recording.

    `index` (n,): the valid frames among these; `t` (n,) [s], `x`, `y` (n,) [m]: their times and places; `entry`: the
    motion at the first of them.
    """

    start: int
    stop: int
    index: np.ndarray
    t: np.ndarray
    x: np.ndarray
    y: np.ndarray
    entry: LocalMotion


@dataclass(frozen=True)
class Segments:
    """The segments of a recording.

    `noise`: of the puck's place and the frames' clock; `held`, `wild` (frames,) bool: repeated frames and outliers;
    `glides` and `contacts`: in order of time; `launches`: (start, stop) frames of uninterrupted motion; `let_go`:
    whether a hand let the puck go at the beginning of each; `lines`: coordinate [m] of the puck's centre at contact
    with each wall.
    """

    noise: Noise
    held: np.ndarray
    wild: np.ndarray
    glides: tuple[Glide, ...]
    contacts: tuple[ContactEvent, ...]
    launches: tuple[tuple[int, int], ...]
    let_go: tuple[bool, ...]
    lines: dict[str, float]

    @property
    def noise_std(self) -> float:
        """Standard deviation [m] of each coordinate of a slow puck."""
        return self.noise.position

    def of_kind(self, kind: str) -> list[ContactEvent]:
        """The contacts of one kind, in order of time."""
        return [contact for contact in self.contacts if contact.kind == kind]


def segment(recording: Recording) -> Segments:
    """Cut `recording` into segments; a recording without a puck has none."""
    g = causes.geometry(recording)
    frames = recording.frames
    x = np.zeros(0) if frames is None else frames["puck_x"]
    y = np.zeros(0) if frames is None else frames["puck_y"]
    t = np.zeros(0) if frames is None else frames.t
    held, far = held_frames(x, y), recording.outside()
    noise, path, wild = valid_path(t, np.stack([x, y], axis=1), held, far)
    if len(path.t) < SEGMENTATION.glide_frames:
        return Segments(noise, held, wild, (), (), (), (), causes.nominal_lines(g))
    tracks = causes.mallet_tracks(recording, path.t)
    expected = causes.possible(g, path.p, tracks, noise.position)
    strength = changepoints.find_changepoints(path.t, path.p, noise, path.jumps, expected)
    events = find_events(path, noise, strength)
    place = np.array([event.place for event in events]).reshape(-1, 2)
    v_in = np.array([event.left.velocity for event in events]).reshape(-1, 2)
    v_out = np.array([event.right.velocity for event in events]).reshape(-1, 2)
    lines = causes.measured_lines(g, place, v_in, v_out)
    contacts = [contact for event in events for contact in attribute(event, path, g, lines, tracks)]
    glides, pushes = _glides(path, noise, strength > 0)
    contacts = tuple(sorted((*contacts, *pushes), key=lambda contact: contact.t))
    launches = tuple(_launches(path))
    handled = let_go(t, np.stack([x, y], axis=1), launches)
    return Segments(noise, held, wild, tuple(glides), contacts, launches, handled, lines)


def _glides(path: Path, noise: Noise, broken: np.ndarray) -> tuple[list[Glide], list[ContactEvent]]:
    """The free motions between events that are long enough; motions that gain speed, or lose more than sliding costs,
    become unexplained pushes."""
    edges = np.concatenate([[0], np.flatnonzero(path.jumps | broken) + 1, [len(path.t)]])
    glides, pushes, ends = [], [], SEGMENTATION.end_frames
    for a, b in pairwise(edges):
        if b - a < SEGMENTATION.glide_frames:
            continue
        t, p = path.t[a:b], path.p[a:b]
        entry = local_motion(path.t, path.p, t[0], slice(a, min(b, a + ends)), noise)
        last = local_motion(path.t, path.p, t[-1], slice(max(a, b - ends), b), noise)
        gained = float(np.linalg.norm(last.velocity) - np.linalg.norm(entry.velocity))
        std = float(np.hypot(entry.velocity_std, last.velocity_std))
        start, stop = int(path.index[a]), int(path.index[b - 1]) + 1
        speed, span = float(np.linalg.norm(entry.velocity)), float(t[-1] - t[0])
        braked = SEGMENTATION.braked + SEGMENTATION.braked_drag * speed**2
        if gained - 4 * std > SEGMENTATION.pushed * span or -gained - 4 * std > braked * span:
            pushes.append(_push(t[0], p[0], (entry.velocity, last.velocity), std, (start, stop - 1)))
            continue
        glides.append(Glide(start, stop, path.index[a:b], t, p[:, 0], p[:, 1], entry))
    return glides, pushes


def _push(
    t: float, place: np.ndarray, v: tuple[np.ndarray, np.ndarray], v_std: float, frames: tuple[int, int]
) -> ContactEvent:
    x, y = float(place[0]), float(place[1])
    return ContactEvent("unexplained", "pushed", float(t), x, y, v[0], v[1], v_std, frames, 0.0, False)


def _launches(path: Path) -> list[tuple[int, int]]:
    edges = np.concatenate([[0], np.flatnonzero(path.jumps) + 1, [len(path.t)]])
    pairs = pairwise(edges)
    return [(int(path.index[a]), int(path.index[b - 1]) + 1) for a, b in pairs if b - a >= SEGMENTATION.launch_frames]
