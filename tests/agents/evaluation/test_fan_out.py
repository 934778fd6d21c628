"""Independent work gives the same results, in order, wherever it runs."""

import math
import os

import pytest

from agents.evaluation.fan_out import fan_out


def _square(number: int) -> tuple[int, int]:
    return number * number, os.getpid()


@pytest.mark.parametrize("options", [{}, {"workers": 2}])
def test_results_come_in_order(options):
    results = list(fan_out(_square, range(6), **options))
    assert [square for square, _ in results] == [0, 1, 4, 9, 16, 25]
    elsewhere = {process for _, process in results} - {os.getpid()}
    assert bool(elsewhere) == bool(options)


@pytest.mark.slow
def test_a_cluster_gives_the_same_in_order():
    assert list(fan_out(math.isqrt, [16, 4, 9, 1], cluster="local")) == [4, 2, 3, 1]


@pytest.mark.parametrize("address", ["127.0.0.1:1", "ray://127.0.0.1:1", "127.0.0.1:port", "no.such.host.invalid:6379"])
def test_a_wrong_address_is_refused_in_one_line(address: str):
    with pytest.raises(ValueError, match=f"no Ray cluster at {address}: .*; expected host:port, or local"):
        list(fan_out(_square, [1], cluster=address))


def _fails(number: int) -> int:
    raise ValueError(f"no {number}")


@pytest.mark.parametrize("options", [{}, {"workers": 2}])
def test_an_error_in_a_job_is_raised_here(options):
    with pytest.raises(ValueError, match="no 1"):
        list(fan_out(_fails, [1], **options))
