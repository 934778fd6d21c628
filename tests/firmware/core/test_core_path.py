"""The path that the firmware follows against the gantry's equation, in double precision by matrix exponentials."""

from __future__ import annotations

import ctypes as c
from dataclasses import dataclass

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.linalg import expm

from tests.firmware.core.host_core import library
from tests.firmware.core.line import config

BAR = 20e-6  # m over a second
CONFIG = config()


class Axis(c.Structure):
    _fields_ = [(name, c.c_float) for name in ("slow_rate", "fast_rate", "rest_gain", "slow_gain", "fast_gain")]


class Leg(c.Structure):
    _fields_ = [("begin", c.c_uint32), ("rest_of_it", c.c_float * 7)]  # the core's alone


class Path(c.Structure):
    _fields_ = [("legs", Leg * 3)]


class Traj(c.Structure):
    _fields_ = [
        *((name, c.c_uint32) for name in ("sequence", "apply", "life")), ("volts", c.c_float * 2),
        ("t1", c.c_uint32 * 2), ("t2", c.c_uint32 * 2), *((name, c.c_float * 2) for name in ("rest", "slow", "fast")),
    ]  # fmt: skip


def axis_of(which: int) -> Axis:
    axis = Axis()
    numbers = (CONFIG.c5[which], CONFIG.c6[which], CONFIG.c7[which], CONFIG.pulley_radius)
    make = library().axis_make
    make.argtypes, make.restype = [c.POINTER(Axis), *[c.c_float] * 4], c.c_bool
    assert make(c.byref(axis), *numbers)
    return axis


@dataclass(frozen=True)
class Move:
    volts: float
    t1: int
    t2: int
    rest: float
    slow: float
    fast: float

    def path(self, axis: Axis) -> Path:
        path = Path()
        traj = Traj(volts=(self.volts, 0), t1=(self.t1, 0), t2=(self.t2, 0), rest=(self.rest, 0), slow=(self.slow, 0))
        traj.fast[0] = self.fast
        for part in (library().path_begin, library().path_end):
            part(c.byref(path), c.byref(axis), c.byref(traj), 0)
        return path


def places(move: Move, which: int, times: np.ndarray) -> np.ndarray:
    """The oracle: (p, v, a) under C5 p''' + C6 p'' + C7 p' = (R/2) V, from one switch of the voltage to the next."""
    c5, c6, c7 = (float(np.float32(getattr(CONFIG, name)[which])) for name in ("c5", "c6", "c7"))
    half = 0.5 * float(np.float32(CONFIG.pulley_radius))
    fast, slow = np.roots([c5, c6, c7])
    rest0, slow0, fast0 = (float(np.float32(number)) for number in (move.rest, move.slow, move.fast))
    state = np.array([rest0 + slow0 + fast0, slow * slow0 + fast * fast0, slow**2 * slow0 + fast**2 * fast0, 1.0])
    volts, found, now = float(np.float32(move.volts)), [], 0.0
    for begin, end, u in ((0, move.t1, volts), (move.t1, move.t2, -volts), (move.t2, 10**9, 0.0)):
        law = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, -c7 / c5, -c6 / c5, half * u / c5], [0, 0, 0, 0]], float)
        inside = times[(times >= begin) & (times < end)]
        for time in inside:
            state, now = expm(law * (time * 1e-6 - now)) @ state, time * 1e-6
            found.append(state[0])
        if end < 10**9:
            state, now = expm(law * (end * 1e-6 - now)) @ state, end * 1e-6
    return np.array(found)


def place(path: Path, axis: Axis, time: int) -> float:
    function = library().path_place
    function.restype, function.argtypes = c.c_float, [c.POINTER(Path), c.POINTER(Axis), c.c_uint32]
    return function(c.byref(path), c.byref(axis), time)


moves = st.builds(
    lambda volts, t1, more, rest, slow, fast: Move(volts, t1, t1 + more, rest, slow, fast),
    st.floats(-48, 48), st.integers(0, 600_000), st.integers(0, 400_000), st.floats(-1, 1), st.floats(-0.6, 0.6),
    st.floats(-1e-4, 1e-4),
)  # fmt: skip


@settings(max_examples=60, deadline=None)
@given(moves, st.integers(0, 1))
def test_a_path_stays_within_20_um_of_the_closed_form_over_a_second(move: Move, which: int):
    axis, times = axis_of(which), np.arange(0, 1_000_000, 9_973)
    path = move.path(axis)
    got = np.array([place(path, axis, int(time)) for time in times])
    assert np.abs(got - places(move, which, times)).max() < BAR


@settings(max_examples=100, deadline=None)
@given(moves, st.integers(0, 1))
def test_inside_is_told_by_the_way_itself(move: Move, which: int):
    axis = axis_of(which)
    path = move.path(axis)
    way = places(move, which, np.append(np.arange(0, 1_500_000, 5_003), 3_000_000))
    low, high = float(way.min()), float(way.max())
    part = library().leg_inside
    part.restype, part.argtypes = c.c_bool, [c.POINTER(Path), c.c_int, c.POINTER(Axis), c.c_float, c.c_float]

    def inside(low: float, high: float) -> bool:
        return all(part(c.byref(path), leg, c.byref(axis), low, high) for leg in range(3))

    assert inside(low - 5e-3, high + 5e-3)  # 5 mm: what may lie between two samples
    assert not inside(low + 5e-4, 10.0)
    assert not inside(-10.0, high - 5e-4)


def test_volts_are_the_profiles_mean_over_a_tick():
    axis = axis_of(0)
    path = Move(10.0, 2_500, 4_250, 0.0, 0.0, 0.0).path(axis)
    function = library().path_volts
    function.restype, function.argtypes = c.c_float, [c.POINTER(Path), c.c_uint32, c.c_uint32]
    got = [function(c.byref(path), time, 1000) for time in range(0, 6000, 1000)]
    assert got == pytest.approx([10, 10, 0, -10, -2.5, 0])


def test_what_oscillates_is_no_gantry():
    make = library().axis_make
    make.argtypes, make.restype = [c.POINTER(Axis), *[c.c_float] * 4], c.c_bool
    assert not make(c.byref(Axis()), 1e-3, 1e-6, 0.05, 0.035)
