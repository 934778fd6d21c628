"""Counter-based random numbers: SplitMix64 of (key + draws), so that a stream is two integers and can be forked.

Every table has three streams: one a player (what happens to it alone, in its own frame) and one of its own. They
depend on the seed and the table's index alone, never on how many tables there are or which thread serves them.
"""

from __future__ import annotations

import math

import numpy as np

from puckpilot_env.kernel import kernel

TABLE = 2  # the table's own stream; 0 and 1 are the players'
STREAMS = 3

_GOLDEN = np.uint64(0x9E3779B97F4A7C15)
_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S30, _S27, _S31, _S11 = np.uint64(30), np.uint64(27), np.uint64(31), np.uint64(11)
_ONE = np.uint64(1)


@kernel
def mix(z):
    """SplitMix64's finalizer (Steele, Lea, Flood 2014): a bijection of 64-bit integers."""
    z = (z ^ (z >> _S30)) * _MIX_1
    z = (z ^ (z >> _S27)) * _MIX_2
    return z ^ (z >> _S31)


@kernel
def seed_streams(table, seed, index):
    """Start the streams of table number `index` of a batch with this `seed` (both uint64)."""
    base = mix(mix(seed + _GOLDEN) + index * _GOLDEN)
    for stream in range(STREAMS):
        table.keys[stream] = mix(base + np.uint64(stream + 1) * _MIX_1)
        table.draws[stream] = np.uint64(0)


@kernel
def uniform(table, stream):
    """The next number of the stream, uniform in [0, 1)."""
    draws = table.draws[stream] + _ONE
    table.draws[stream] = draws
    return (mix(table.keys[stream] + draws * _GOLDEN) >> _S11) * (1.0 / 9007199254740992.0)


@kernel
def between(table, stream, low, high):
    """Uniform in [low, high)."""
    return low + (high - low) * uniform(table, stream)


@kernel
def normal_pair(table, stream):
    """Two independent standard normal numbers (Box and Muller 1958)."""
    radius = math.sqrt(-2.0 * math.log(1.0 - uniform(table, stream)))
    angle = 2.0 * math.pi * uniform(table, stream)
    return radius * math.cos(angle), radius * math.sin(angle)
