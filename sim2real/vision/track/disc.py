"""Fit a disc of known size to edge points, of which some belong to its rim and some to other things.

Hypotheses go through pairs of points (RANSAC with fixed pairs). The score of one is the number of points that lie on
its rim and face outwards, minus the number of points just outside of it, where a disc has no edges. Points inside do
not count: there the edges of whatever hides the disc may lie. A robust least-squares fit refines the best one.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.vision.track.covariance import deviation
from sim2real.vision.track.film import Film
from sim2real.vision.track.subpixel_edges import EdgePoints

STARTS = 40  # number of first points of pairs
JUDGES = 60  # approximate number of points that vote on a hypothesis
PARTNERS = (0.11, 0.19, 0.31, 0.43)  # steps along the outlines to the second points, as shares of a whole rim's points
WIDE = 1.5  # radii from the centre; farther points belong to other things
NEAR = 0.7  # px, greatest distance from the rim of a point that votes for a hypothesis
FACING = 0.6  # least cosine between the directions in which an edge and the rim face
ROUNDS = 8  # iterations of the refinement at most
STILL = 1e-7  # m, step at which the refinement has converged
SPREAD = (0.04, 0.3)  # px, limits of the estimated scatter of edge points
CUT = 3.0  # scatters, distance from which points have no weight (Tukey's biweight)
BINS = 36  # sectors of the rim
TOGETHER = 4.0  # number of neighbouring points with a common error, the factor of the variance
COMMON = 0.03  # px, standard deviation of the error common to all edges of a disc, which shifts an arc's centre


@dataclass(frozen=True)
class Disc:
    """A fitted disc.

    centre: (2,) [m]; covariance: (2, 2) of the centre [m^2]; seen: share of the rim with edge points; on, outside:
    number of edge points on the rim and outside of it.
    """

    centre: np.ndarray
    covariance: np.ndarray
    seen: float
    on: int
    outside: int

    @property
    def deviation(self) -> float:
        """Standard deviation of the centre in its least certain direction [m]."""
        return deviation(self.covariance)


def find_disc(edge: EdgePoints, film: Film) -> Disc | None:
    """The best disc of this film through edge points; None if no three points agree on one."""
    if len(edge) < 3:
        return None
    centre, covariance, counts = np.zeros(2), np.zeros((2, 2)), np.zeros(3, np.int64)
    common = math.hypot(COMMON, film.edge_deviation(float(np.linalg.norm(edge.steps[len(edge) // 2]))))
    if not _find(edge.places, edge.steps, (film.radius, film.spread), common, centre, covariance, counts):
        return None
    on, outside, bins = counts.tolist()
    return Disc(centre, covariance, bins / BINS, on, outside)


@array_kernel
def _find(places, steps, size, common, centre, covariance, counts):
    """Find the best disc; fill its centre (2,), covariance (2, 2) and counts (3,). Returns whether there is one.

    size: the film's radius [m] and its spread [px]; common: standard deviation of the error common to all edges [px].
    """
    if _guess(places, steps, size, centre) <= 0.0:
        return False
    normal, total = np.zeros((2, 2)), np.zeros(2)
    scatter = _refine(places, steps, size, centre, normal, total)
    if scatter <= 0.0:
        return False
    _count(places, steps, size, scatter, centre, np.zeros(BINS, np.bool_), counts)
    _spread(normal, total, scatter, common, covariance)
    return counts[0] >= 3


@kernel
def _off(places, steps, i, size, x, y):
    """The distance [px] of point i from the rim round (x, y) as it is seen, positive outside, and whether it faces
    outwards."""
    dx, dy = places[i, 0] - x, places[i, 1] - y
    far = math.sqrt(dx * dx + dy * dy)
    step = math.sqrt(steps[i, 0] * steps[i, 0] + steps[i, 1] * steps[i, 1])
    if far == 0.0 or step == 0.0:
        return -math.inf, False
    gain = (steps[i, 0] * dx + steps[i, 1] * dy) / far  # m along the radius for a pixel outwards
    return (far - size[0]) / max(gain, FACING * step) - size[1], gain > FACING * step


@kernel
def _is_wide(places, i, size, x, y):
    """Whether point i lies too far from (x, y) to say anything of a disc there."""
    dx, dy, wide = places[i, 0] - x, places[i, 1] - y, WIDE * size[0]
    return dx * dx + dy * dy >= wide * wide


@kernel
def _score(places, steps, size, x, y, stride, best):
    """The score of a hypothesis from every `stride`-th point: points on the rim minus points outside; `best`
    as soon as it cannot be more than that."""
    score, count = 0, places.shape[0]
    for i in range(0, count, stride):
        off, faces = _off(places, steps, i, size, x, y)
        if abs(off) < NEAR and faces:
            score += 1
        elif off >= 2.0 * NEAR and not _is_wide(places, i, size, x, y):
            score -= 1
        if score + (count - 1 - i) // stride <= best:
            return best
    return score


@kernel
def _guess(places, steps, size, centre):
    """Write the centre of the best hypothesis into `centre` (2,) and return its score."""
    count = places.shape[0]
    stride = max(count // JUDGES, 1)
    pixel = math.hypot(steps[count // 2, 0], steps[count // 2, 1])
    radius = size[0] + size[1] * pixel
    whole = 2.0 * math.pi * radius / pixel
    most = (count + stride - 1) // stride
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
                if not (_off(places, steps, i, size, x, y)[1] and _off(places, steps, j, size, x, y)[1]):
                    continue
                score = _score(places, steps, size, x, y, stride, best)
                if score > best:
                    best = score
                    centre[0], centre[1] = x, y
                if score == most:
                    return best
    return best


@array_kernel
def _refine(places, steps, size, centre, normal, total):
    """Refine `centre` (2,) by robust least squares of the points' distances from the rim [px] (Gauss-Newton, Tukey's
    biweight).

    Fills the normal matrix (2, 2) [px^2/m^2], and in `total` its right side (2,) [px/m] for points that all lie one
    pixel outside. Returns the scatter of the points [px], 0 if they do not determine a centre.
    """
    count = places.shape[0]
    off, near = np.empty(count), np.empty(count)
    scatter = SPREAD[1]
    for _ in range(ROUNDS):
        normal[:] = 0.0
        total[:] = 0.0
        right_x, right_y, kept = 0.0, 0.0, 0
        for i in range(count):
            off[i], faces = _off(places, steps, i, size, centre[0], centre[1])
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
def _spread(normal, total, scatter, common, covariance):
    """Fill the centre's covariance (2, 2) [m^2]: the scatter of points, correlated between neighbours, and the error
    common to all."""
    det = normal[0, 0] * normal[1, 1] - normal[0, 1] ** 2
    xx, xy, yy = normal[1, 1] / det, -normal[0, 1] / det, normal[0, 0] / det
    leaning_x, leaning_y = common * (xx * total[0] + xy * total[1]), common * (xy * total[0] + yy * total[1])
    covariance[0, 0] = TOGETHER * scatter**2 * xx + leaning_x * leaning_x
    covariance[1, 1] = TOGETHER * scatter**2 * yy + leaning_y * leaning_y
    covariance[0, 1] = covariance[1, 0] = TOGETHER * scatter**2 * xy + leaning_x * leaning_y


@kernel
def _count(places, steps, size, scatter, centre, bins, counts):
    """Fill `counts` (3,): points on the rim, points outside, and sectors of the rim with points, marked in `bins`."""
    for i in range(places.shape[0]):
        away, faces = _off(places, steps, i, size, centre[0], centre[1])
        if faces and abs(away) < CUT * scatter:
            counts[0] += 1
            angle = math.atan2(places[i, 1] - centre[1], places[i, 0] - centre[0])
            part = int((angle / (2.0 * math.pi) + 0.5) * BINS) % BINS
            counts[2] += not bins[part]
            bins[part] = True
        elif away > 2.0 * NEAR and not _is_wide(places, i, size, centre[0], centre[1]):
            counts[1] += 1
