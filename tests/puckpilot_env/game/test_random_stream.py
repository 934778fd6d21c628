"""Random streams against SplitMix64 in plain integers, published values, and statistics."""

from __future__ import annotations

from typing import Any

import numba
import numpy as np
import pytest
from scipy import stats

from puckpilot_env import Tables
from puckpilot_env.game import random_stream
from puckpilot_env.game.random_stream import STREAM

pytestmark = pytest.mark.slow

MASK = 2**64 - 1
GOLDEN = 0x9E3779B97F4A7C15
# The first outputs of the generator from 1234567, as published with its reference code.
PUBLISHED = [
    6457827717110365317,
    3203168211198807973,
    9817491932198370423,
    4593380528125082431,
    16408922859458223821,
]


def splitmix64(state: int) -> tuple[int, int]:
    """`(state, output)` of the reference generator's next step, in unbounded integers."""
    state = (state + GOLDEN) & MASK
    z = state
    z = ((z ^ (z >> 30)) * 0xBF58476D1CE4E5B9) & MASK
    z = ((z ^ (z >> 27)) * 0x94D049BB133111EB) & MASK
    return state, z ^ (z >> 31)


def stream_of(key: int, draws: int = 0) -> Any:
    return np.array([(key, draws)], STREAM)[0]


def seeded(seed: int, index: int, number: int) -> Any:
    stream = stream_of(0)
    random_stream.seed_stream(stream, np.uint64(seed), np.uint64(index), number)
    return stream


def take(stream: Any, count: int, draw: Any = random_stream.uniform) -> np.ndarray:
    return np.array([draw(stream) for _ in range(count)])


def test_published_values():
    state = 1234567
    for expected in PUBLISHED:
        state, output = splitmix64(state)
        assert output == expected
    assert take(stream_of(1234567), 5).tolist() == [(value >> 11) / 2**53 for value in PUBLISHED]


@pytest.mark.parametrize("key", [0, 1, 2**63, MASK, 0xDEADBEEFCAFE])
def test_like_the_reference_generator(key):
    """All 64-bit arithmetic wraps round, and nothing passes through a float or a signed integer."""
    stream, state = stream_of(key), key
    for _ in range(200):
        state, output = splitmix64(state)
        assert random_stream.uniform(stream) == (output >> 11) / 2**53
    assert stream["draws"] == 200 and stream["key"] == key


def test_a_stream_is_two_integers():
    """Any draw can be asked for by its number; a copy goes on alike, and apart from the original."""
    numbers = take(stream_of(77), 50)
    assert random_stream.uniform(stream_of(77, 31)) == numbers[31]
    stream = stream_of(77, 10)
    fork = stream.copy()
    assert take(stream, 20).tolist() == numbers[10:30].tolist()
    assert fork["draws"] == 10
    assert take(fork, 20).tolist() == numbers[10:30].tolist()


def test_uniform():
    numbers = take(seeded(5, 3, 1), 40_000)
    assert numbers.min() >= 0.0 and numbers.max() < 1.0
    assert stats.kstest(numbers, "uniform").pvalue > 1e-3
    pairs = np.histogram2d(numbers[:-1], numbers[1:], bins=20, range=[[0, 1], [0, 1]])[0]
    assert stats.chisquare(pairs.ravel()).pvalue > 1e-3  # a number does not tell the next


def test_between():
    numbers = take(seeded(5, 3, 1), 2000)
    between = take(seeded(5, 3, 1), 2000, lambda stream: random_stream.between(stream, -3.0, 5.0))
    np.testing.assert_allclose(between, -3.0 + 8.0 * numbers, rtol=1e-14)


@numba.njit
def take_pairs(stream, out):
    for i in range(len(out)):
        out[i] = random_stream.normal_pair(stream)


PAIRS = 4_000_000


@pytest.fixture(scope="module")
def pairs() -> np.ndarray:
    """(PAIRS, 2) normal numbers of one stream."""
    found = np.zeros((PAIRS, 2))
    stream = seeded(9, 0, 2)
    take_pairs(stream, found)
    assert PAIRS < stream["draws"] < 1.06 * PAIRS  # seldom more than 64 bits
    return found


@pytest.mark.parametrize("which", [0, 1])
def test_normal_numbers_are_normal(pairs, which):
    """Each of a pair: the whole distribution, bins of a thousandth, moments."""
    numbers = pairs[:, which]
    assert stats.kstest(numbers, "norm").pvalue > 1e-3
    edges = stats.norm.ppf(np.linspace(0.0, 1.0, 1001))
    assert stats.chisquare(np.histogram(numbers, edges)[0]).pvalue > 1e-3
    for power, moment, variance in ((1, 0.0, 1.0), (2, 1.0, 2.0), (3, 0.0, 15.0), (4, 3.0, 96.0)):
        assert np.mean(numbers**power) == pytest.approx(moment, abs=4.0 * np.sqrt(variance / PAIRS))


@pytest.mark.parametrize("beyond", [3.0, 3.65, 3.66, 4.0, 4.5])
@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_the_tails_of_normal_numbers(pairs, beyond, sign):
    """As many as there should be, before and after the ziggurat's tail begins at 3.654."""
    expected = pairs.size * stats.norm.sf(beyond)
    assert (sign * pairs > beyond).sum() == pytest.approx(expected, abs=4.0 * np.sqrt(expected))


def test_normal_numbers_do_not_tell_each_other(pairs):
    for a, b in ((pairs[:, 0], pairs[:, 1]), (pairs[:-1, 0], pairs[1:, 0]), (pairs[:-1, 1], pairs[1:, 0])):
        for power in (1, 2):
            assert abs(np.corrcoef(a**power, b**power)[0, 1]) < 4.0 / np.sqrt(len(a))


def test_streams_tables_and_seeds_are_independent():
    """First numbers over 200 tables of 10 seeds, 3 streams each: uniform, unlike each other, uncorrelated."""
    first = np.array([[[seeded(s, i, k) for k in range(3)] for i in range(200)] for s in range(10)])
    assert len(np.unique(first["key"])) == first.size
    numbers = np.array([take(stream, 2) for stream in first.ravel()]).reshape(10, 200, 3, 2)
    assert stats.kstest(numbers.ravel(), "uniform").pvalue > 1e-3
    flat = numbers.reshape(-1, 6)  # a table's three streams, two numbers each
    neighbours = [(flat[:, i], flat[:, j]) for i in range(6) for j in range(i)]
    neighbours.append((numbers[:, :-1].ravel(), numbers[:, 1:].ravel()))  # tables beside each other
    neighbours.append((numbers[:-1].ravel(), numbers[1:].ravel()))  # seeds beside each other
    for a, b in neighbours:
        assert abs(np.corrcoef(a, b)[0, 1]) < 4.0 / np.sqrt(a.size)


def test_tables_have_a_stream_for_each_player_and_one_of_their_own():
    states = Tables("match-v0", 40, seed=8).states
    for i in (0, 17, 39):
        keys = [
            int(states["streams"]["key"][i, 0]),
            int(states["streams"]["key"][i, 1]),
            int(states["stream"]["key"][i]),
        ]
        assert keys == [int(seeded(8, i, number)["key"]) for number in range(3)]
