"""The glides of a recording as flat arrays, grouped into launches, without those that are no smooth motion."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from scipy.stats import chi2

from sim2real.diagnose.contacts import Geometry, Track, near_mallets, near_posts, near_walls
from sim2real.diagnose.glide.memory import Memory, Stretch, remembered
from sim2real.diagnose.glide.uneven import uneven, unevenness
from sim2real.diagnose.pieces import Glide, Pieces
from sim2real.diagnose.sensor import Noise

SMOOTH_ORDER = 4  # a free glide is a polynomial of this order in time, to the sensor's noise
SMOOTH_CHANCE = 1e-4  # chance at which a true glide is refused
FEWEST_FRAMES = 12  # of a glide: its start takes four of 24 numbers
HIDDEN = 0.003  # m, from a wall, post or mallet; nearer, a slow contact may hide
LONGEST_CLUSTER = 6.0  # s; a longer launch counts as several
SLOWEST = 0.02  # m/s; a slower puck is at rest and tells nothing


@dataclass(frozen=True)
class GlideData:
    """`n` frames in `g` glides, of which number i has the frames first[i] … first[i + 1] − 1.

    `t` (n,) [s], `place` (n, 2) [m], `std` (n, 2) [m] of each coordinate; for each glide: its `cluster` (launch), its
    `recording`, and `since` [s], the time of the contact before it (nan where none was seen). For each recording:
    `memories` of its errors, and `place_std` [m], by which its calibration has all places wrong.
    """

    t: np.ndarray
    place: np.ndarray
    std: np.ndarray
    first: np.ndarray
    cluster: np.ndarray
    recording: np.ndarray
    since: np.ndarray
    memories: tuple[Memory, ...] = (Memory(),)
    place_std: tuple[float, ...] = (0.0,)

    @property
    def glides(self) -> int:
        return len(self.cluster)

    @property
    def clusters(self) -> int:
        return int(self.cluster.max()) + 1 if len(self.cluster) else 0

    def of_frame(self, values: np.ndarray) -> np.ndarray:
        """Values of the glides (g, …) repeated for each of their frames (n, …)."""
        return np.repeat(values, np.diff(self.first), axis=0)


def glide_data(pieces: Pieces, g: Geometry, tracks: Mapping[str, Track], place_std: float = 0.0) -> GlideData:
    """The glides of `pieces` that move and are smooth; launches in order of time are the clusters.

    `g` and `tracks` (of the mallets, at the recording's frames) say where a slow contact could have gone unnoticed;
    `place_std` [m] by what the calibration has all places wrong.

    Where most glides are less smooth than the sensor's noise explains, the noise is taken as what they leave; and where
    errors hang together from frame to frame, as what `memory` finds. That is asked of a calibrated camera alone: of
    another, what hangs together are errors of the places themselves, which last as long as forces do.
    """
    free = [_clear_part(glide, pieces, g, tracks) for glide in pieces.glides]
    long = [k for k, glide in enumerate(free) if _moves(glide)]
    rough = np.array([_roughness(free[k], pieces.noise) for k in long]).reshape(-1, 2)
    excess = max(float(np.median(rough[:, 0] / rough[:, 1])), 1.0) if len(long) else 1.0
    smooth = rough[:, 0] < 1.1 * excess * chi2.isf(SMOOTH_CHANCE, rough[:, 1])
    kept = [k for k, fine in zip(long, smooth, strict=True) if fine]
    glides = [free[k] for k in kept]
    frames = [len(glide.t) for glide in glides]
    place = [np.stack([glide.x, glide.y], axis=1) for glide in glides]
    std = [np.sqrt(excess) * pieces.noise.std(_speed(glide)) for glide in glides]
    memory = Memory()
    if place_std:
        std, memory = _calibrated(glides, place, std)
    ends = np.array([hit.t for hit in pieces.hits])
    return GlideData(
        np.concatenate([glide.t for glide in glides]) if glides else np.zeros(0),
        np.concatenate(place) if glides else np.zeros((0, 2)),
        memory.scale * np.concatenate(std) if glides else np.zeros((0, 2)),
        np.concatenate([[0], np.cumsum(frames)]).astype(int),
        _clusters(pieces, glides),
        np.zeros(len(glides), int),
        np.array([_last_contact(glide, ends) for glide in glides]),
        (memory,),
        (place_std,),
    )


def join(parts: Sequence[GlideData]) -> GlideData:
    """The glides of several recordings of one table; their launches stay apart."""
    frames = np.cumsum([0, *(len(part.t) for part in parts)])
    launches = np.cumsum([0, *(part.clusters for part in parts)])
    return GlideData(
        np.concatenate([part.t for part in parts]),
        np.concatenate([part.place for part in parts]),
        np.concatenate([part.std for part in parts]),
        np.concatenate([[0], *(part.first[1:] + n for part, n in zip(parts, frames, strict=False))]).astype(int),
        np.concatenate([part.cluster + n for part, n in zip(parts, launches, strict=False)]).astype(int),
        np.concatenate([np.full(part.glides, k) for k, part in enumerate(parts)]).astype(int),
        np.concatenate([part.since for part in parts]),
        tuple(one for part in parts for one in part.memories),
        tuple(one for part in parts for one in part.place_std),
    )


def _clear_part(glide: Glide, pieces: Pieces, g: Geometry, tracks: Mapping[str, Track]) -> Glide:
    """The longest part of a glide away from walls, posts and mallets, by more than a slow contact could hide in."""
    p = np.stack([glide.x, glide.y], axis=1)
    reach = HIDDEN + 4.0 * pieces.noise.position
    near = near_walls(pieces.lines, p, reach) | near_posts(g, p, reach) | near_mallets(g, tracks, glide.index, p, reach)
    edges = np.flatnonzero(np.diff(np.concatenate([[True], near, [True]]).astype(int)))
    starts, stops = edges[::2], edges[1::2]
    if not len(starts):
        return replace(glide, t=glide.t[:0], x=glide.x[:0], y=glide.y[:0], index=glide.index[:0])
    k = int(np.argmax(stops - starts))
    part = slice(starts[k], stops[k])
    return replace(glide, t=glide.t[part], x=glide.x[part], y=glide.y[part], index=glide.index[part])


def _moves(glide: Glide) -> bool:
    return len(glide.t) >= FEWEST_FRAMES and bool(np.hypot(*_speed(glide).mean(axis=0)) > SLOWEST)


def _speed(glide: Glide) -> np.ndarray:
    """Speed of each coordinate (frames, 2) [m/s], from a parabola through the glide."""
    u = glide.t - glide.t.mean()
    slopes = [np.polyval(np.polyder(np.polyfit(u, q, 2)), u) for q in (glide.x, glide.y)]
    return np.stack(slopes, axis=1)


def _roughness(glide: Glide, noise: Noise) -> tuple[float, int]:
    """Sum of squares, in units of the noise, that a polynomial leaves of a glide, and its degrees of freedom."""
    u = (glide.t - glide.t.mean()) / np.ptp(glide.t)
    order = min(SMOOTH_ORDER, len(u) // 4)
    design = np.vander(u, order + 1)
    rest = 0.0
    for q, std in zip((glide.x, glide.y), noise.std(_speed(glide)).T, strict=True):
        a = design / std[:, None]
        rest += np.linalg.norm(q / std - a @ np.linalg.lstsq(a, q / std, rcond=None)[0]) ** 2
    return float(rest), 2 * (len(u) - order - 1)


def _calibrated(glides: list[Glide], place: list[np.ndarray], std: list[np.ndarray]) -> tuple[list[np.ndarray], Memory]:
    """The noise (n, 2) of a calibrated camera in each glide, by where it was, and what hangs together of it."""
    told = unevenness(_stretches(glides, place, std), SMOOTH_ORDER)
    std = [one * uneven(there, told) for one, there in zip(std, place, strict=True)]
    return std, remembered(_stretches(glides, place, std), SMOOTH_ORDER, _period(glides))


def _stretches(glides: list[Glide], place: list[np.ndarray], std: list[np.ndarray]) -> list[Stretch]:
    return [Stretch(glide.t, *both) for glide, *both in zip(glides, place, std, strict=True)]


def _period(glides: list[Glide]) -> float:
    """Time between frames [s]."""
    return float(np.median(np.concatenate([np.diff(glide.t) for glide in glides]))) if glides else 0.0


def _clusters(pieces: Pieces, glides: list[Glide]) -> np.ndarray:
    """Number of the launch of each glide; one that lasts longer than LONGEST_CLUSTER is cut at a glide's start."""
    found = np.zeros(len(glides), int)
    cluster, launch, begun = -1, -1, 0.0
    starts = np.array([start for start, _ in pieces.launches])
    for k, glide in enumerate(glides):
        here = int(np.searchsorted(starts, glide.start, side="right"))
        if here != launch or glide.t[-1] - begun > LONGEST_CLUSTER:
            cluster, launch, begun = cluster + 1, here, float(glide.t[0])
        found[k] = cluster
    return found


def _last_contact(glide: Glide, contacts: np.ndarray) -> float:
    before = contacts[contacts < glide.t[0] + 1e-9]
    return float(before[-1]) if len(before) and glide.t[0] - before[-1] < 0.05 else np.nan
