"""A disc of known radius from some of its rim: the rest may be hidden, and points may belong to other things.

Hypotheses go through pairs of edge points; each is worth the points that lie on its rim and face outwards, less those
that lie just outside, where the disc has no edge. What lies inside says nothing: there whatever hides the disc ends.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.vision.track.rim import Rim
from sim2real.vision.track.two_by_two import deviation

STARTS = 40  # first points of pairs
JUDGES = 60  # points, about, by which a hypothesis is judged
PARTNERS = (0.11, 0.19, 0.31, 0.43)  # of a whole rim's points: how far on along the outlines the second ones are
WIDE = 1.5  # radii from the centre: what is farther off belongs to other things
NEAR = 0.7  # px from the rim that count as on it, for a hypothesis
FACING = 0.6  # cosine between where an edge faces and where the rim does, at least
ROUNDS = 8  # of the refinement at most,
STILL = 1e-7  # m: which ends when the centre moves less
SPREAD = (0.04, 0.3)  # px, the least and the greatest scatter that edges are taken to have
CUT = 3.0  # times the scatter: farther points have no weight (Tukey's biweight)
BINS = 36  # parts of the rim
TOGETHER = 4.0  # neighbouring points that err as one: so much greater is the variance than that of as many points
COMMON = 0.03  # px: standard deviation of what all edges of a disc err by alike, which an arc's centre follows


@dataclass(frozen=True)
class Disc:
    """A disc: its centre (2,) [m], the centre's covariance (2, 2) [m^2], the share of the rim that was seen, and how
    many edge points lie on it and outside of it."""

    centre: np.ndarray
    covariance: np.ndarray
    seen: float
    on: int
    outside: int

    @property
    def deviation(self) -> float:
        """Standard deviation of the centre in its least certain direction [m]."""
        return deviation(self.covariance)


def find_disc(rim: Rim, radius: float) -> Disc | None:
    """The best disc of this radius [m]; None where no three points agree on one."""
    centre, covariance, counts = np.zeros(2), np.zeros((2, 2)), np.zeros(3, np.int64)
    if len(rim) < 3 or not _find(rim.places, rim.steps, radius, centre, covariance, counts):
        return None
    on, outside, bins = counts.tolist()
    return Disc(centre, covariance, bins / BINS, on, outside)


@array_kernel
def _find(places, steps, radius, centre, covariance, counts):
    """Put the best disc's centre, its covariance and `_count` of it where they belong; whether there is one."""
    if _guess(places, steps, radius, centre) <= 0.0:
        return False
    normal, total = np.zeros((2, 2)), np.zeros(2)
    scatter = _refine(places, steps, radius, centre, normal, total)
    if scatter <= 0.0:
        return False
    _count(places, steps, radius, scatter, centre, np.zeros(BINS, np.bool_), counts)
    _spread(normal, total, scatter, covariance)
    return counts[0] >= 3


@kernel
def _off(places, steps, i, radius, x, y):
    """How far [px] point i lies outside of the rim round (x, y), and whether it faces as the rim does there."""
    dx, dy = places[i, 0] - x, places[i, 1] - y
    far = math.hypot(dx, dy)
    step = math.hypot(steps[i, 0], steps[i, 1])
    if far == 0.0 or step == 0.0:
        return -math.inf, False
    gain = (steps[i, 0] * dx + steps[i, 1] * dy) / far  # m along the radius for a pixel outwards
    return (far - radius) / max(gain, FACING * step), gain > FACING * step


@kernel
def _worth(places, steps, radius, x, y, stride):
    """Points on the rim less points outside, of every `stride`-th."""
    worth = 0
    for i in range(0, places.shape[0], stride):
        off, faces = _off(places, steps, i, radius, x, y)
        if abs(off) < NEAR and faces:
            worth += 1
        elif off >= 2.0 * NEAR and math.hypot(places[i, 0] - x, places[i, 1] - y) < WIDE * radius:
            worth -= 1
    return worth


@kernel
def _guess(places, steps, radius, centre):
    """Put the best hypothesis into `centre` (2,); its worth."""
    count = places.shape[0]
    stride = max(count // JUDGES, 1)
    whole = 2.0 * math.pi * radius / math.hypot(steps[count // 2, 0], steps[count // 2, 1])
    all_of_them = (count + stride - 1) // stride
    best = 0
    for start in range(min(STARTS, count)):
        i = start * count // min(STARTS, count)
        for share in PARTNERS:
            j = (i + int(share * whole)) % count
            dx, dy = places[j, 0] - places[i, 0], places[j, 1] - places[i, 1]
            apart = math.hypot(dx, dy)
            if apart == 0.0 or apart >= 2.0 * radius:
                continue
            aside = math.sqrt(radius * radius - 0.25 * apart * apart) / apart
            for side in (-1.0, 1.0):
                x = 0.5 * (places[i, 0] + places[j, 0]) - side * aside * dy
                y = 0.5 * (places[i, 1] + places[j, 1]) + side * aside * dx
                if not (_off(places, steps, i, radius, x, y)[1] and _off(places, steps, j, radius, x, y)[1]):
                    continue
                worth = _worth(places, steps, radius, x, y, stride)
                if worth > best:
                    best = worth
                    centre[0], centre[1] = x, y
                if worth == all_of_them:
                    return best
    return best


@array_kernel
def _refine(places, steps, radius, centre, normal, total):
    """Move `centre` to where the points' distances from the rim [px] are least (Gauss, Newton; Tukey's weights). Fill
    the normal matrix (2, 2) [px^2/m^2], and its right side (2,) [px/m] for points that all lie a pixel outside. The
    points' scatter [px]; 0 where they tell no centre."""
    count = places.shape[0]
    off, near = np.empty(count), np.empty(count)
    scatter = SPREAD[1]
    for _ in range(ROUNDS):
        normal[:] = 0.0
        total[:] = 0.0
        right_x, right_y, kept = 0.0, 0.0, 0
        for i in range(count):
            off[i], faces = _off(places, steps, i, radius, centre[0], centre[1])
            share = off[i] / (CUT * scatter)
            if not faces or abs(share) >= 1.0:
                continue
            near[kept] = abs(off[i])
            kept += 1
            weight = (1.0 - share * share) ** 2
            dx, dy = places[i, 0] - centre[0], places[i, 1] - centre[1]
            gain = (steps[i, 0] * dx + steps[i, 1] * dy) / (dx * dx + dy * dy)
            along_x, along_y = dx / (gain * (dx * dx + dy * dy)), dy / (gain * (dx * dx + dy * dy))
            normal[0, 0] += weight * along_x * along_x
            normal[0, 1] += weight * along_x * along_y
            normal[1, 1] += weight * along_y * along_y
            total[0] += weight * along_x
            total[1] += weight * along_y
            right_x += weight * along_x * off[i]
            right_y += weight * along_y * off[i]
        normal[1, 0] = normal[0, 1]
        det = normal[0, 0] * normal[1, 1] - normal[0, 1] ** 2
        if kept < 3 or det <= 0.0:
            return 0.0
        move_x = (normal[1, 1] * right_x - normal[0, 1] * right_y) / det
        move_y = (normal[0, 0] * right_y - normal[0, 1] * right_x) / det
        centre[0] += move_x
        centre[1] += move_y
        scatter = min(max(1.4826 * np.median(near[:kept]), SPREAD[0]), SPREAD[1])
        if max(abs(move_x), abs(move_y)) < STILL:
            break
    return scatter


@kernel
def _spread(normal, total, scatter, covariance):
    """The centre's covariance (2, 2) [m^2]: of what points err by, neighbours alike, and of what all err by."""
    det = normal[0, 0] * normal[1, 1] - normal[0, 1] ** 2
    xx, xy, yy = normal[1, 1] / det, -normal[0, 1] / det, normal[0, 0] / det
    leaning_x, leaning_y = COMMON * (xx * total[0] + xy * total[1]), COMMON * (xy * total[0] + yy * total[1])
    covariance[0, 0] = TOGETHER * scatter**2 * xx + leaning_x * leaning_x
    covariance[1, 1] = TOGETHER * scatter**2 * yy + leaning_y * leaning_y
    covariance[0, 1] = covariance[1, 0] = TOGETHER * scatter**2 * xy + leaning_x * leaning_y


@kernel
def _count(places, steps, radius, scatter, centre, bins, counts):
    """Count points on the rim, points outside, and the parts of the rim, `bins`, that the former show."""
    for i in range(places.shape[0]):
        away, faces = _off(places, steps, i, radius, centre[0], centre[1])
        if faces and abs(away) < CUT * scatter:
            counts[0] += 1
            angle = math.atan2(places[i, 1] - centre[1], places[i, 0] - centre[0])
            part = int((angle / (2.0 * math.pi) + 0.5) * BINS) % BINS
            counts[2] += not bins[part]
            bins[part] = True
        elif away > 2.0 * NEAR and math.hypot(places[i, 0] - centre[0], places[i, 1] - centre[1]) < WIDE * radius:
            counts[1] += 1
