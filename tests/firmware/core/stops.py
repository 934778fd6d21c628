"""Stops of a pushed mallet on the core's bench, and what they take: `python -m tests.firmware.core.stops`."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from sim2real.link.wire.messages import Config, Disarm, Ping
from tests.firmware.core.bench import FULL, Bench, with_parity
from tests.firmware.core.line import config

MOST = 15.0  # V at a motor
MOVING = 0.05  # m/s
LONGEST = 75  # ticks that it brakes at most
STEP = 0.2  # m/s a tick, by which a mallet may be pushed so that its encoders are believed
WIDE = {"x": (-5.0, 5.0), "y": (-5.0, 5.0), "silence": 1000}
NOISE = 3.0  # steps of an encoder: what an AS5147's data sheet states as its rms, 0.068 degrees


class Plugged(Bench):
    """A bench whose motors may be on each other's plug."""

    swapped = False

    def _move(self) -> None:
        self.pwm = self.pwm[::-1] if self.swapped else self.pwm
        super()._move()


@dataclass
class Stop:
    """How a mallet was stopped, tick by tick from the order on: speeds [m/s], ways from there [m], volts of motors."""

    speeds: np.ndarray
    ways: np.ndarray
    volts: np.ndarray

    @property
    def rest(self) -> int:
        """Ticks until it moves no more."""
        moving = np.flatnonzero(np.hypot(*self.speeds.T) >= MOVING)
        return int(moving[-1]) + 1 if len(moving) else 0

    @property
    def off(self) -> int:
        """Ticks until the motors are off for good."""
        driven = np.flatnonzero(self.volts.any(axis=1))
        return int(driven[-1]) + 1 if len(driven) else 0


def gantry(strength: float = 1.0, **changed: object) -> Plugged:
    """Armed, with motors of this strength beside what the core is told."""
    bench = Plugged(config(most_volts=MOST, **{**WIDE, **changed}), start=(0.5, 0.5))
    bench.armed()
    for axis in bench.axes:
        slow_rate, fast_rate, *gains = axis.constants
        rest_gain, slow_gain, fast_gain = (strength * one for one in gains)
        axis.constants = slow_rate, fast_rate, rest_gain, slow_gain, fast_gain
    return bench


def pushed(bench: Plugged, speed: tuple[float, float]) -> None:
    """Bring it to this speed, as fast as encoders believe."""
    for number in range(1, math.ceil(max(map(abs, speed)) / STEP) + 1):
        for axis, whole in zip(bench.axes, speed, strict=True):
            axis.push(math.copysign(min(abs(whole), number * STEP), whole))
        bench.send(Ping(number))
        bench.tick()
    for axis, whole in zip(bench.axes, speed, strict=True):
        axis.push(whole)


def noisy(bench: Bench, seed: int) -> None:
    """Encoders whose answers scatter."""
    random = np.random.default_rng(seed)
    for encoder in bench.encoders:
        encoder.spoil = lambda answer: with_parity(round((answer & 0x3FFF) + random.normal(0.0, NOISE)) & 0x3FFF)


def stopped(bench: Bench, *order: object, ticks: int = LONGEST + 5) -> Stop:
    """How it stops once it is ordered to."""
    start, seen = np.array(bench.place), []
    bench.send(*order)
    for _ in range(ticks):
        bench.tick()
        seen.append((bench.speed, bench.place - start, np.array(bench.pwm) * bench.config.supply / FULL))
    return Stop(*(np.array(column) for column in zip(*seen, strict=True)))


def time_and_way(axis: int, speed: float, volts: float, c: Config) -> tuple[float, float]:
    """Seconds and metres in which constant volts stop an axis, by hand: v' = -R V/(2 C6) - (C7/C6) v."""
    force, drag = c.pulley_radius * volts / (2.0 * c.c6[axis]), c.c7[axis] / c.c6[axis]
    time = math.log1p(speed * drag / force) / drag
    return time, speed / drag - force / drag * time


def _printed(what: str, stops: list[Stop]) -> None:
    rest, off = max(stop.rest for stop in stops), max(stop.off for stop in stops)
    way = max(np.hypot(*stop.ways.T).max() for stop in stops)
    volts = max(np.abs(stop.volts).max() for stop in stops)
    back = max(-(stop.speeds * np.sign(stop.speeds[0])).min() for stop in stops)
    print(f"{what}: at rest in {rest} ms, {1000.0 * way:.0f} mm on, back at {back:.3f} m/s, "
          f"{volts:.2f} V, off in {off} ms")  # fmt: skip


def _drawn(count: int, random: np.random.Generator) -> list[Stop]:
    """Stops from motions in all directions, noisy, by motors up to 30 % stronger or weaker than the core is told."""
    stops = []
    for seed in range(count):
        angle, speed = random.uniform(0.0, 2.0 * np.pi), random.uniform(0.2, 3.0)
        bench = gantry(random.uniform(0.7, 1.3))
        pushed(bench, (speed * np.cos(angle), speed * np.sin(angle)))
        noisy(bench, seed)
        stops.append(stopped(bench, Disarm()))
    return stops


if __name__ == "__main__":
    for name, motion in (("x", (3.0, 0.0)), ("y", (0.0, 3.0)), ("both axes", (3.0, 3.0))):
        mallet = gantry()
        pushed(mallet, motion)
        _printed(f"from 3 m/s along {name}", [stopped(mallet, Disarm())])
    _printed("500 drawn stops", _drawn(500, np.random.default_rng(1)))
