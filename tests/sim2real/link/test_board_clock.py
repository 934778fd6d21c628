"""The board's clock against simulated lines, of which the truth is known."""

from __future__ import annotations

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from sim2real.link.board_clock import MOST_DRIFT, BoardClock
from tests.sim2real.link.simulated_line import Line, error_us

SETTLED = 5.0  # s of pings after which the bar holds


def followed(
    line: Line, seconds: float = 30.0, settled: float = SETTLED
) -> tuple[BoardClock, list[float], list[float]]:
    """A clock at the end, its errors until the next ping [us], and its bounds there [us]."""
    clock, errors, bounds, begin = BoardClock(), [], [], None
    for exchange in line.exchanges(seconds):
        begin = exchange[0] if begin is None else begin
        assert clock.add(*exchange)
        if exchange[0] - begin >= settled:
            for later in (0.0, 0.05):
                at = exchange[3] + later
                errors.append(error_us(line, clock.to_board(at), at))
                bounds.append(1e6 * clock.error_s(at))
    return clock, errors, bounds


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(8))
def test_within_a_tenth_of_a_millisecond(seed):
    drift = (50e-6, -50e-6, 90e-6, 0.0)[seed % 4]
    clock, errors, bounds = followed(Line(seed, drift), seconds=20.0)
    assert max(map(abs, errors)) <= 100.0
    assert clock.drift == pytest.approx(drift, abs=5e-6)
    assert clock.jumps == 0
    assert abs(clock.drift - drift) <= clock.drift_error < 50e-6
    assert all(abs(error) <= bound for error, bound in zip(errors, bounds, strict=True))
    assert max(bounds) < 600.0


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(4))
def test_jitter_of_one_direction_alone(seed):
    """Way back 20 times as ragged as the way there; a mean of round trips would be 2 ms off."""
    line = Line(
        seed, there=lambda rng: 0.2e-3 + rng.exponential(0.1e-3), back=lambda rng: 0.2e-3 + rng.exponential(4e-3)
    )
    _, errors, bounds = followed(line, settled=15.0)
    assert max(map(abs, errors)) <= 100.0
    assert all(abs(error) <= bound for error, bound in zip(errors, bounds, strict=True))


@pytest.mark.slow
@pytest.mark.parametrize("there, back", [(0.0, 3e-3), (3e-3, 0.0)])
def test_the_bound_holds_where_one_way_is_always_longer(there, back):
    """No exchange can tell: 1.5 ms of error, and the bound says so."""
    line = Line(3, there=lambda rng: there + rng.uniform(0, 1e-4), back=lambda rng: back + rng.uniform(0, 1e-4))
    _, errors, bounds = followed(line)
    assert 1.0e3 < max(map(abs, errors)) < 2e3
    assert all(abs(error) <= bound for error, bound in zip(errors, bounds, strict=True))
    assert np.median(bounds) < 2.2e3


@pytest.mark.slow
@pytest.mark.parametrize("before", [0.3, 5.0, 12.0])
def test_the_wrap_inside(before):
    start = (2**32 - round((5000.0 + before) * 1e6 * (1 + 50e-6))) % 2**32
    line = Line(1, start=start)
    assert any(b < a for a, b in zip(*[[e[1] for e in line.exchanges(15.0)][k:] for k in (0, 1)], strict=False))
    clock, errors, _ = followed(line, seconds=15.0)
    assert max(map(abs, errors)) <= 100.0 and clock.jumps == 0


def test_there_and_back_again():
    clock, _, _ = followed(Line(2), seconds=12.0)
    for at in (5003.0, 5012.0, 5012.5):
        assert clock.to_host(clock.to_board(at)) == pytest.approx(at, abs=1e-6)


def test_a_long_pause_and_many_wraps():
    """Three hours without a word: two wraps, and the clock is right again with the first exchange."""
    line, clock = Line(4), BoardClock()
    for exchange in line.exchanges(5.0):
        clock.add(*exchange)
    for exchange in line.exchanges(1.0, begin=16_000.0):
        clock.add(*exchange)
        assert abs(error_us(line, clock.to_board(exchange[3]), exchange[3])) < 6e3
    assert len(clock) == 20 and clock.jumps == 0


def test_after_a_jump_of_the_boards_clock_the_new_time_holds():
    old, new, clock = Line(5), Line(6, start=777), BoardClock()
    for exchange in old.exchanges(5.0):
        clock.add(*exchange)
    for exchange in new.exchanges(3.0, begin=5010.0 - 5.0):
        clock.add(*exchange)
    assert clock.jumps >= 1
    assert abs(error_us(new, clock.to_board(5008.0), 5008.0)) <= 100.0


def test_the_first_exchange_is_bound_by_its_round_trip():
    line, clock = Line(7), BoardClock()
    exchange = next(line.exchanges(1.0))
    clock.add(*exchange)
    half = 0.5 * (exchange[3] - exchange[0] - 1e-6 * (exchange[2] - exchange[1]))
    assert clock.error_s() == pytest.approx(half, abs=5e-6)
    assert clock.error_s(exchange[3] + 1.0) == pytest.approx(half + 300e-6, abs=10e-6)  # drift unknown as yet


def test_nothing_is_known_without_an_exchange():
    clock = BoardClock()
    assert clock.error_s() == math.inf
    for ask in (clock.to_board, clock.to_host):
        with pytest.raises(ValueError, match="no ping was answered yet; poll until one is"):
            ask(5)


@pytest.mark.parametrize("exchange", [(1.0, 500, 400, 1.1), (1.0, 0, 300_000, 1.1), (1.1, 0, 10, 1.0)])
def test_an_exchange_that_cannot_be_is_refused(exchange):
    clock = BoardClock()
    assert not clock.add(*exchange) and len(clock) == 0


@given(
    st.lists(
        st.tuples(st.floats(0, 0.2), st.integers(0, 2**32 - 1), st.integers(0, 3000), st.floats(0, 0.02)), max_size=12
    )
)
def test_no_answers_at_all_upset_it(answers):
    """Stamps of a board gone mad: each exchange is taken or refused, and the newest taken stays inside its bound."""
    clock, now = BoardClock(), 10.0
    for wait, received, spent, trip in answers:
        sent, now = now + wait, now + wait + trip
        if clock.add(sent, received, (received + spent) % 2**32, now):
            assert sent - clock.error_s(sent) - 2e-6 <= clock.to_host(received) <= now + clock.error_s(now) + 2e-6


def test_superfluous_exchanges_bind_no_line():
    """Against the lines by all exchanges of the window, whatever the slope; few of them are kept."""
    clock, line = BoardClock(), Line(3, 50e-6)
    for exchange in line.exchanges(40.0):
        clock.add(*exchange)
    ping_sent, received = clock._newest()[:2]
    since = np.array([(a - ping_sent, b - received, c - received, d - ping_sent) for a, b, c, d in clock._exchanges])
    there, back = 1e-6 * since[:, 1], 1e-6 * since[:, 2]
    slopes = np.linspace(-MOST_DRIFT, MOST_DRIFT, 41)[:, None]
    lowest = (since[:, 0] - there - 1e-6 - slopes * there).max(axis=1)
    highest = (since[:, 3] - back - slopes * back).min(axis=1)
    lines = clock._lines()
    assert [lines._lowest(slope)[0] for slope in slopes[:, 0]] == pytest.approx(lowest, abs=1e-12)
    assert [lines._highest(slope)[0] for slope in slopes[:, 0]] == pytest.approx(highest, abs=1e-12)
    assert len(clock._below) < len(clock) / 2 and len(clock._above) < len(clock) / 2
