"""Counter-based random numbers: SplitMix64 of (key + draws), so that a stream is two integers and can be forked.

Every table has three streams: one a player (what happens to it alone, in its own frame) and one of its own. They
depend on the seed and the table's index alone, never on how many tables there are or which thread serves them.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import inlined_kernel, kernel

STREAM = np.dtype([("key", np.uint64), ("draws", np.uint64)], align=True)

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11, _S32 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11), np.uint64(32)
_ONE, _LOW = np.uint64(1), np.uint64(2**32 - 1)
_HALF_PLACES, _PLACE = 2**23 - 0.5, 1.0 / 2**23

# The ziggurat (Marsaglia, Tsang 2000; Doornik 2005): layers of equal area under exp(-x^2/2), layer i from -_EDGE[i] to
# _EDGE[i] and from _HEIGHT[i] up to _HEIGHT[i + 1]. Layer 0 is the lowest, with the tail beyond _TAIL folded into it.
LAYERS = 256
_TAIL, _AREA = 3.6541528853610088, 0.00492867323399


def _layers() -> tuple[np.ndarray, np.ndarray]:
    edges = [_AREA / math.exp(-0.5 * _TAIL * _TAIL), _TAIL]
    while len(edges) < LAYERS:
        edges.append(math.sqrt(-2.0 * math.log(_AREA / edges[-1] + math.exp(-0.5 * edges[-1] ** 2))))
    heights = [0.0, *(math.exp(-0.5 * edge * edge) for edge in edges[1:]), 1.0]
    return np.array([*edges, 0.0]), np.array(heights)


_EDGE, _HEIGHT = _layers()


@inlined_kernel
def mix(z):
    """SplitMix64's finalizer (Steele, Lea, Flood 2014): a bijection of 64-bit integers."""
    z = (z ^ (z >> _S30)) * _MIX_1
    z = (z ^ (z >> _S27)) * _MIX_2
    return z ^ (z >> _S31)


@kernel
def seed_stream(stream, seed, index, number):
    """Start stream `number` (0, 1, ..) of table number `index` of a batch with this `seed` (uint64, uint64, int)."""
    base = mix(mix(seed + _GOLDEN) + index * _GOLDEN)
    stream.key = mix(base + np.uint64(number + 1) * _MIX_1)
    stream.draws = np.uint64(0)


@inlined_kernel
def _next(stream):
    """The next 64 bits of the stream."""
    draws = stream.draws + _ONE
    stream.draws = draws
    return mix(stream.key + draws * _GOLDEN)


@inlined_kernel
def uniform(stream):
    """The next number of the stream, uniform in [0, 1)."""
    return (_next(stream) >> _S11) * (1.0 / 9007199254740992.0)


@kernel
def between(stream, low, high):
    """Uniform in [low, high)."""
    return low + (high - low) * uniform(stream)


@inlined_kernel
def normal_pair(stream):
    """Two standard normal numbers, of 24 bits each; they take 64 bits of the stream, seldom more (the ziggurat).

    Noise comes in pairs, one number for either axis.
    """
    bits = _next(stream)
    x, first = _under_layer(np.int64(bits >> _S32))
    y, second = _under_layer(np.int64(bits & _LOW))
    if (abs(x) < _EDGE[first + 1]) & (abs(y) < _EDGE[second + 1]):
        return x, y
    return _normal(stream, first, x), _normal(stream, second, y)


@inlined_kernel
def _under_layer(bits):
    """`(x, layer)` of 32 bits: 8 choose a layer, the others a place in it."""
    layer = bits & (LAYERS - 1)
    return ((bits >> 8) - _HALF_PLACES) * _PLACE * _EDGE[layer], layer


@kernel
def _normal(stream, layer, x):
    """A standard normal number from a place `x` in a layer."""
    return x if abs(x) < _EDGE[layer + 1] else _normal_beside(stream, layer, x)


@kernel
def _normal_beside(stream, layer, x):
    """`_normal` where `x` lies beside the part of its layer that is wholly under the curve."""
    while True:
        if layer == 0:
            return math.copysign(_normal_tail(stream), x)
        height = _HEIGHT[layer] + (_HEIGHT[layer + 1] - _HEIGHT[layer]) * uniform(stream)
        if height < math.exp(-0.5 * x * x):
            return x
        bits = _next(stream)
        layer = np.int64(bits & np.uint64(LAYERS - 1))
        x = (np.int64(bits >> _S11) * (1.0 / 4503599627370496.0) - 1.0) * _EDGE[layer]
        if abs(x) < _EDGE[layer + 1]:
            return x


@kernel
def _normal_tail(stream):
    """A normal number that is known to be above `_TAIL` (Marsaglia 1964)."""
    while True:
        beyond = -math.log(1.0 - uniform(stream)) / _TAIL
        if -2.0 * math.log(1.0 - uniform(stream)) > beyond * beyond:
            return _TAIL + beyond
