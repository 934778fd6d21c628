"""Two circles round one middle, from edge points that face outwards on one and inwards on the other."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.vision.track.bright import FEWEST

OFF = 1.5e-3  # m from a circle: farther points are others'
FACING = 0.6  # cosine between where an edge faces and where its circle does, at least
STARTS = 32  # first points of triples
ALONG = (0.06, 0.12)  # of all points, how far on along the outline the next of a triple is
JUDGES = 60  # points, about, by which a hypothesis is judged
LARGEST = 0.08  # m, radius
ROUNDS = 8  # of the fit at most,
STILL = 1e-6  # m: which ends when nothing moves more
SINGULAR = 1e-9  # determinant of the normal matrix
BINS = 36  # parts of a circle


@kernel
def _side(places, steps, i, x, y):
    """Distance [m] of point i from (x, y), and whether it faces outwards (1), inwards (-1) or aside (0) there."""
    dx, dy = places[i, 0] - x, places[i, 1] - y
    far = math.hypot(dx, dy)
    facing = steps[i, 0] * dx + steps[i, 1] * dy
    limit = FACING * far * math.hypot(steps[i, 0], steps[i, 1])
    return far, 1 if facing > limit else -1 if facing < -limit else 0


@kernel
def guess_hole(places, steps, found):
    """Write centre and hole's radius on which most points lie and face inwards into `found` (x, y, outer, hole): the
    best of circles through three points each. How many of some."""
    count = places.shape[0]
    stride = max(count // JUDGES, 1)
    best = 0
    for start in range(min(STARTS, count)):
        i = start * count // min(STARTS, count)
        for share in ALONG:
            step = max(int(share * count), 1)
            j, k = (i + step) % count, (i + 2 * step) % count
            ax, ay = places[j, 0] - places[i, 0], places[j, 1] - places[i, 1]
            bx, by = places[k, 0] - places[i, 0], places[k, 1] - places[i, 1]
            twice = 2.0 * (ax * by - ay * bx)
            if twice == 0.0:
                continue
            aa, bb = ax * ax + ay * ay, bx * bx + by * by
            dx, dy = (by * aa - ay * bb) / twice, (ax * bb - bx * aa) / twice
            radius = math.hypot(dx, dy)
            if radius > LARGEST:
                continue
            x, y = places[i, 0] + dx, places[i, 1] + dy
            if _side(places, steps, i, x, y)[1] >= 0 or _side(places, steps, k, x, y)[1] >= 0:
                continue
            on = 0
            for n in range(0, count, stride):
                far, side = _side(places, steps, n, x, y)
                if side < 0 and abs(far - radius) < OFF:
                    on += 1
            if on > best:
                best = on
                found[0], found[1], found[3] = x, y, radius
    return best


@array_kernel
def fit_circles(places, steps, found, covariance):
    """Move `found` (x, y, outer and hole's radius), of which the outer one is not known yet, to where the squares of
    the points' distances from their circles are least (Gauss, Newton; Tukey's weights). Fill the centre's covariance
    (2, 2) [m^2] for points that err by a metre. False where too few points agree."""
    count = places.shape[0]
    outer, many = np.empty(count), 0
    for i in range(count):
        far, side = _side(places, steps, i, found[0], found[1])
        if side > 0 and far < LARGEST:
            outer[many] = far
            many += 1
    if many < FEWEST:
        return False
    found[2] = np.median(outer[:many])
    for turn in range(ROUNDS):
        limit = OFF if turn else 2.0 * OFF
        normal, right, on = np.zeros((4, 4)), np.zeros(4), np.zeros(2)
        for i in range(count):
            far, side = _side(places, steps, i, found[0], found[1])
            which = 3 if side < 0 else 2
            miss = far - found[which]
            if side == 0 or abs(miss) >= limit:
                continue
            on[which - 2] += 1
            weight = (1.0 - (miss / limit) ** 2) ** 2
            slope = ((places[i, 0] - found[0]) / far, (places[i, 1] - found[1]) / far)
            for a in range(2):
                right[a] += weight * slope[a] * miss
                normal[a, which] += weight * slope[a]
                normal[which, a] += weight * slope[a]
                for b in range(2):
                    normal[a, b] += weight * slope[a] * slope[b]
            right[which] += weight * miss
            normal[which, which] += weight
        if on.min() < FEWEST or np.linalg.det(normal) < SINGULAR:
            return False
        move = np.linalg.solve(normal, right)
        found += move
        if turn and np.abs(move).max() < STILL:
            break
    covariance[:] = np.linalg.inv(normal)[:2, :2]
    return True


@array_kernel
def shares_of_circles(places, steps, found):
    """Of two circles (x, y, outer and hole's radius): how much of the outer one is seen, and of the hole's, and how
    many of the points inside the outer one that face inwards lie on the hole's, as shares (3,)."""
    bins = np.zeros((2, BINS), np.bool_)
    inwards, on = 0, 0
    for i in range(places.shape[0]):
        far, side = _side(places, steps, i, found[0], found[1])
        which = 3 if side < 0 else 2
        close = side != 0 and abs(far - found[which]) < OFF
        if side < 0 and far < found[2]:
            inwards += 1
            on += close
        if close:
            angle = math.atan2(places[i, 1] - found[1], places[i, 0] - found[0])
            bins[which - 2, int((angle / (2.0 * math.pi) + 0.5) * BINS) % BINS] = True
    return bins[0].mean(), bins[1].mean(), on / max(inwards, 1)
