"""Fit two concentric circles: edge points on the outer circle face outwards, those on the hole's circle inwards."""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import array_kernel, kernel
from sim2real.vision.track.blobs import FEWEST

OFF = 1.5e-3  # m, greatest distance of a point from its circle
FACING = 0.6  # least cosine between the directions in which an edge and its circle face
STARTS = 32  # number of first points of triples
ALONG = (0.06, 0.12)  # steps along the outline between the points of a triple, as shares of all points
JUDGES = 60  # approximate number of points that vote on a hypothesis
LARGEST = 0.08  # m, greatest radius
ROUNDS = 8  # iterations of the fit at most
STILL = 1e-6  # m, step at which the fit has converged
SINGULAR = 1e-9  # least determinant of the normal matrix
BINS = 36  # sectors of a circle


@kernel
def _side(places, steps, i, x, y):
    """The distance [m] of point i from (x, y), and whether its edge faces outwards (1), inwards (-1) or neither (0)."""
    dx, dy = places[i, 0] - x, places[i, 1] - y
    far = math.sqrt(dx * dx + dy * dy)
    facing = steps[i, 0] * dx + steps[i, 1] * dy
    limit = FACING * far * math.sqrt(steps[i, 0] * steps[i, 0] + steps[i, 1] * steps[i, 1])
    return far, 1 if facing > limit else -1 if facing < -limit else 0


@kernel
def guess_hole(places, steps, found):
    """Search the hole's circle by hypotheses through three points each (RANSAC with fixed triples).

    places: (n, 2) edge points [m]; steps: (n, 2) [m/pixel], outwards. Writes the centre and the hole's radius of the
    hypothesis with the most inward-facing points into `found` (x, y, outer radius, hole's radius) [m]. Returns the
    number of its votes, 0 if there is none.
    """
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
                elif on + (count - 1 - n) // stride <= best:  # it cannot be better any more
                    break
            if on > best:
                best = on
                found[0], found[1], found[3] = x, y, radius
    return best


@array_kernel
def fit_circles(places, steps, found, covariance):
    """Refine `found` (x, y, outer radius, hole's radius) [m] by robust least squares of the points' distances from
    their circles (Gauss-Newton, Tukey's biweight). The outer radius needs no initial value.

    Fills `covariance` (2, 2) of the centre for points with a standard deviation of 1 m. Returns False if too few points
    agree.
    """
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
    """How well points support two circles (x, y, outer radius, hole's radius) [m], as three shares from 0 to 1: of
    the outer circle that is seen, of the hole's circle that is seen, and of the inward-facing points inside the outer
    circle that lie on the hole's."""
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
