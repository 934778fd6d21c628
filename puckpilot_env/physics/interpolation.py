"""Functions of one number that a table of numbers says: cosines, and straight pieces between knots."""

from __future__ import annotations

import math

from puckpilot_env.kernel import kernel


@kernel
def cosines(c, a):
    """Sum of a_i cos(i h), where `c` is cos h (Clenshaw 1955)."""
    last, before = 0.0, 0.0
    for i in range(len(a) - 1, 0, -1):
        last, before = a[i] + 2.0 * c * last - before, last
    return a[0] + c * last - before


@kernel
def over_knots(x, knots, values):
    """Straight pieces through `values` at `knots`, level beyond."""
    if x <= knots[0]:
        return values[0]
    for i in range(1, len(knots)):
        if x < knots[i]:
            return values[i - 1] + (values[i] - values[i - 1]) * (x - knots[i - 1]) / (knots[i] - knots[i - 1])
    return values[len(values) - 1]


@kernel
def over_even_knots(share, values):
    """Straight pieces through `values` at even steps from share 0 to 1, level beyond."""
    place = min(max(share, 0.0), 1.0) * (len(values) - 1)
    i = min(int(place), len(values) - 2)
    return values[i] + (values[i + 1] - values[i]) * (place - i)


@kernel
def next_knot(x, x1, knots):
    """Share of the way from `x` to `x1` at which the next knot lies; infinite if there is none, in that direction."""
    share = math.inf
    for i in range(len(knots)):
        if (knots[i] - x) * (x1 - x) > 0.0:
            share = min(share, (knots[i] - x) / (x1 - x))
    return share


@kernel
def share_of_time(way, v, v1):
    """The share of the time that a share `way` of a straight way takes, along which the speed goes from `v` to `v1`."""
    if way < 1.0 and v1 < v:  # the first part of a way takes less than its share of the time
        way *= (v + v1) / (v + math.sqrt(v * v + way * (v1 * v1 - v * v)))
    return way


@kernel
def next_even_knot(x, x1, first, last, count):
    """The same of `count` even knots from `first` to `last`, where x1 > x."""
    gap = (last - first) / (count - 1)
    if not gap > 0.0 or x >= last:
        return math.inf
    knot = first + gap * max(math.floor((x - first) / gap) + 1.0, 0.0)
    return (knot - x) / (x1 - x)
