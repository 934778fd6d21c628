"""Counter-based random numbers: SplitMix64 of (key + draws), so that a stream is two integers and can be forked.

Every table has three streams: one a player (what happens to it alone, in its own frame) and one of its own. They
depend on the seed and the table's index alone, never on how many tables there are or which thread serves them.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel

STREAM = np.dtype([("key", np.uint64), ("draws", np.uint64)], align=True)

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_ONE = np.uint64(1)
_TAIL = 0.02425


@kernel
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


@kernel
def uniform(stream):
    """The next number of the stream, uniform in [0, 1)."""
    draws = stream.draws + _ONE
    stream.draws = draws
    return (mix(stream.key + draws * _GOLDEN) >> _S11) * (1.0 / 9007199254740992.0)


@kernel
def between(stream, low, high):
    """Uniform in [low, high)."""
    return low + (high - low) * uniform(stream)


@kernel
def normal(stream):
    """The next number of the stream, standard normal, by the inverse of its distribution (Acklam's approximation).

    Its relative error, under 1.2e-9, is far below anything that is simulated here; it needs no pairs and, in 95 of 100
    cases, no logarithm.
    """
    u = uniform(stream)
    if u < _TAIL:
        return _normal_tail(max(u, 1e-300))
    if u > 1.0 - _TAIL:
        return -_normal_tail(max(1.0 - u, 1e-300))
    q = u - 0.5
    r = q * q
    above = ((((-39.69683028665376 * r + 220.9460984245205) * r - 275.9285104469687) * r + 138.3577518672690) * r
             - 30.66479806614716) * r + 2.506628277459239  # fmt: skip
    below = ((((-54.47609879822406 * r + 161.5858368580409) * r - 155.6989798598866) * r + 66.80131188771972) * r
             - 13.28068155288572) * r + 1.0  # fmt: skip
    return q * above / below


@kernel
def _normal_tail(u):
    """`normal` for u < _TAIL."""
    q = math.sqrt(-2.0 * math.log(u))
    above = ((((-0.007784894002430293 * q - 0.3223964580411365) * q - 2.400758277161838) * q - 2.549732539343734) * q
             + 4.374664141464968) * q + 2.938163982698783  # fmt: skip
    below = (
        ((0.007784695709041462 * q + 0.3224671290700398) * q + 2.445134137142996) * q + 3.754408661907416
    ) * q + 1.0
    return above / below
