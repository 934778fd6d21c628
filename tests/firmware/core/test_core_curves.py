"""The core's curves against the C library's in double precision."""

from __future__ import annotations

import ctypes as c
import math

import numpy as np
import pytest

from tests.firmware.core.host_core import library

EVERYWHERE = np.concatenate([[0.0], np.logspace(-9, 1.9, 4000)]).astype(np.float32)


def of(name: str, value: float) -> float:
    function = getattr(library(), name)
    function.restype, function.argtypes = c.c_float, [c.c_float]
    return function(value)


def test_decay():
    for x in EVERYWHERE:
        assert of("decay", x) == pytest.approx(math.exp(-x), rel=1e-7)
    assert of("decay", 80.0) == 0.0 == of("decay", math.inf)


def test_root():
    for x in [*EVERYWHERE[1:], 1e-12, 1e6, 7.1e-5]:
        assert of("root", x) == pytest.approx(math.sqrt(float(np.float32(x))), rel=2e-7)


def test_log_above():
    for z in [*EVERYWHERE, 1e3, 1e6, 1e20]:
        assert of("log_above", z) == pytest.approx(math.log1p(float(z)), rel=3e-7, abs=1.3e-7)
