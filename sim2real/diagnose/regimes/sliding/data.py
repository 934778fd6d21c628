"""The glides of a recording as flat arrays, grouped by launch; glides that are not smooth are omitted."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
from scipy.stats import chi2

from sim2real.diagnose.regimes.sliding.tuned import SLIDING
from sim2real.diagnose.sensor_noise.autocorrelated import Excerpt, polynomial_residual
from sim2real.diagnose.sensor_noise.model import GlideTrack, SensorNoise, estimate_sensor_noise
from sim2real.segmentation.causes import Geometry, Track, near_mallets, near_posts, near_walls
from sim2real.segmentation.segments import Glide, Segments
from sim2real.segmentation.sensor_noise import Noise


@dataclass(frozen=True)
class GlideData:
    """`n` frames in `g` glides; glide i has the frames first[i] … first[i + 1] − 1.

    `t` (n,) [s], `place` (n, 2) [m], and the standard deviation `std` (n, 2) [m] of the noise of each coordinate. For
    each glide: its `cluster` (launch), its `recording`, and `since` [s], the time of the contact before it (nan if none
    was recorded). For each recording: the `noise` of its camera.
    """

    t: np.ndarray
    place: np.ndarray
    std: np.ndarray
    first: np.ndarray
    cluster: np.ndarray
    recording: np.ndarray
    since: np.ndarray
    noise: tuple[SensorNoise, ...] = (SensorNoise(),)

    @property
    def glides(self) -> int:
        """Number of glides."""
        return len(self.cluster)

    @property
    def clusters(self) -> int:
        """Number of launches."""
        return int(self.cluster.max()) + 1 if len(self.cluster) else 0

    @property
    def noise_of_glide(self) -> list[SensorNoise]:
        """The noise of the camera of each glide (g,)."""
        return [self.noise[recording] for recording in self.recording]

    def of_frame(self, values: np.ndarray) -> np.ndarray:
        """Repeat values of the glides (g, …) for each of their frames (n, …)."""
        return np.repeat(values, np.diff(self.first), axis=0)


class SmoothGlides(NamedTuple):
    """Glides (g) in order of time, the launch `cluster` (g,) of each, and the `excess` [1] of their variance about
    polynomials over that of the white sensor noise, at least 1."""

    glides: list[Glide]
    cluster: np.ndarray
    excess: float


def smooth_glides(segments: Segments, g: Geometry, tracks: Mapping[str, Track]) -> SmoothGlides:
    """Select the glides of `segments` that move and are smooth; the clusters are the launches in order of time.

    `g` and `tracks` (of the mallets, at the recording's frames) give the places where a slow contact may be hidden. If
    most glides are rougher than the white sensor noise explains, the others are compared with the median.
    """
    free = [_clear_part(glide, segments, g, tracks) for glide in segments.glides]
    long = [k for k, glide in enumerate(free) if _moves(glide)]
    rough = np.array([_roughness(free[k], segments.noise) for k in long]).reshape(-1, 2)
    excess = max(float(np.median(rough[:, 0] / rough[:, 1])), 1.0) if len(long) else 1.0
    smooth = rough[:, 0] < SLIDING.smooth_slack * excess * chi2.isf(SLIDING.smooth_chance, rough[:, 1])
    glides = [free[k] for k, fine in zip(long, smooth, strict=True) if fine]
    return SmoothGlides(glides, _clusters(segments, glides), excess)


def glide_data(segments: Segments, g: Geometry, tracks: Mapping[str, Track], map_error_std: float = 0.0) -> GlideData:
    """The data of the `smooth_glides`, with the noise of their camera, scaled up to their roughness.

    `map_error_std` [m]: the stated error of the camera's calibration.
    """
    glides, cluster, excess = smooth_glides(segments, g, tracks)
    measured = [GlideTrack(one.t, np.stack([one.x, one.y], axis=1), _speed(one)) for one in glides]
    noise = estimate_sensor_noise(segments.noise, excess, measured, SLIDING.smooth_order, map_error_std)
    contact_times = np.array([contact.t for contact in segments.contacts])
    return GlideData(
        np.concatenate([np.zeros(0), *(one.t for one in measured)]),
        np.concatenate([np.zeros((0, 2)), *(one.place for one in measured)]),
        np.concatenate([np.zeros((0, 2)), *(noise.std(one) for one in measured)]),
        np.cumsum([0, *(len(one.t) for one in measured)]),
        cluster,
        np.zeros(len(glides), int),
        np.array([_last_contact(glide, contact_times) for glide in glides]),
        (noise,),
    )


def join(parts: Sequence[GlideData]) -> GlideData:
    """Concatenate the glides of several recordings of one table; launches are numbered over all recordings."""
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
        tuple(one for part in parts for one in part.noise),
    )


def _clear_part(glide: Glide, segments: Segments, g: Geometry, tracks: Mapping[str, Track]) -> Glide:
    """The longest part of a glide so far from walls, posts and mallets that no slow contact can be hidden in it."""
    p = np.stack([glide.x, glide.y], axis=1)
    reach = SLIDING.clearance + SLIDING.clearance_stds * segments.noise.position
    near = (
        near_walls(segments.lines, p, reach) | near_posts(g, p, reach) | near_mallets(g, tracks, glide.index, p, reach)
    )
    edges = np.flatnonzero(np.diff(np.concatenate([[True], near, [True]]).astype(int)))
    starts, stops = edges[::2], edges[1::2]
    if not len(starts):
        return replace(glide, t=glide.t[:0], x=glide.x[:0], y=glide.y[:0], index=glide.index[:0])
    k = int(np.argmax(stops - starts))
    part = slice(starts[k], stops[k])
    return replace(glide, t=glide.t[part], x=glide.x[part], y=glide.y[part], index=glide.index[part])


def _moves(glide: Glide) -> bool:
    """Whether a glide is long and fast enough to show a force."""
    return len(glide.t) >= SLIDING.fewest_frames and bool(np.hypot(*_speed(glide).mean(axis=0)) > SLIDING.slowest)


def _speed(glide: Glide) -> np.ndarray:
    """Speed of each coordinate (frames, 2) [m/s], from a parabola through the glide."""
    u = glide.t - glide.t.mean()
    slopes = [np.polyval(np.polyder(np.polyfit(u, q, 2)), u) for q in (glide.x, glide.y)]
    return np.stack(slopes, axis=1)


def _roughness(glide: Glide, noise: Noise) -> tuple[float, int]:
    """Residual sum of squares of polynomials through a glide, in units of the noise, and its degrees of freedom."""
    excerpt = Excerpt(glide.t, np.stack([glide.x, glide.y], axis=1), noise.std(_speed(glide)))
    return polynomial_residual(excerpt, SLIDING.smooth_order)[:2]


def _clusters(segments: Segments, glides: list[Glide]) -> np.ndarray:
    """Number of the launch of each glide; launches longer than `longest_cluster` are cut at the start of a glide."""
    found = np.zeros(len(glides), int)
    cluster, launch, begun = -1, -1, 0.0
    starts = np.array([start for start, _ in segments.launches])
    for k, glide in enumerate(glides):
        here = int(np.searchsorted(starts, glide.start, side="right"))
        if here != launch or glide.t[-1] - begun > SLIDING.longest_cluster:
            cluster, launch, begun = cluster + 1, here, float(glide.t[0])
        found[k] = cluster
    return found


def _last_contact(glide: Glide, contacts: np.ndarray) -> float:
    """Time [s] of the contact at which a glide begins, among the times `contacts`; nan if there is none."""
    before = contacts[contacts < glide.t[0] + 1e-9]
    return float(before[-1]) if len(before) and glide.t[0] - before[-1] < SLIDING.contact_gap else np.nan
