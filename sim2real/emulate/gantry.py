"""The gantry on the emulated board: it turns the duties of two motors into the angles of two shafts (report E.1).

With `Vx = V1 - V2`, `Vy = -V1 - V2`, each axis obeys `C5 p''' + C6 p'' + C7 p' = (R/2) V`; under constant volts its
modes have a closed form (`puckpilot_env.physics.gantry.mallet`), so the result does not depend on the sampling.
The shafts' angles are `T1 = (x - y)/R`, `T2 = (-x - y)/R`.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

from puckpilot_env.parameters import make_records
from puckpilot_env.physics.gantry.mallet import axis_constants
from sim2real.emulate.machine import Machine

US = 1e-6


class GantryAxis:
    """One axis in modal coordinates: its place is `rest + slow + fast` [m] at the time of the last change of voltage.

    c5, c6, c7: coefficients of the equation [V s^3, V s^2, V s]; pulley_radius: [m]; place: at rest [m]. Raises
    ValueError for a gantry that is not overdamped.
    """

    def __init__(self, c5: float, c6: float, c7: float, pulley_radius: float, place: float) -> None:
        constants = axis_constants(c5, c6, c7, pulley_radius)
        if math.isnan(constants[0]):
            raise ValueError(f"C5, C6, C7 are {c5}, {c6}, {c7}; expected an overdamped gantry: C6^2 > 4 C5 C7, all > 0")
        self.slow_rate, self.fast_rate, self.rest_gain, self.slow_gain, self.fast_gain = constants
        self.rest, self.slow, self.fast, self.volts = place, 0.0, 0.0, 0.0

    def after(self, seconds: float) -> tuple[float, float, float]:
        """The modes rest, slow and fast [m] after so many seconds at the present voltage."""
        slow_end, fast_end = -self.slow_gain * self.volts, self.fast_gain * self.volts
        return (
            self.rest + self.rest_gain * self.volts * seconds,
            slow_end + (self.slow - slow_end) * math.exp(-self.slow_rate * seconds),
            fast_end + (self.fast - fast_end) * math.exp(-self.fast_rate * seconds),
        )

    def velocity_after(self, seconds: float) -> float:
        """The velocity [m/s] after so many seconds at the present voltage."""
        _, slow, fast = self.after(seconds)
        return -self.slow_rate * slow - self.fast_rate * fast


class Gantry:
    """A gantry that is connected to a machine's motors and encoders.

    parameters: by the names of `puckpilot_env.parameters`, default values otherwise; place: of the mallet at rest [m];
    zero: angles of the encoders' magnets on their shafts [rad]. The voltage of a motor is its duty times `max_voltage`;
    the ripple of the PWM is averaged.
    """

    def __init__(
        self,
        machine: Machine,
        parameters: Mapping[str, float] | None = None,
        place: tuple[float, float] = (0.1, 0.2),
        zero: tuple[float, float] = (0.0, 0.0),
    ) -> None:
        p = make_records(1, parameters)[0]
        self._supply, self._radius = float(p["max_voltage"]), float(p["pulley_radius"])
        self._zero = zero
        self.axes = tuple(
            GantryAxis(
                float(p["a1"] + sign * p["b1"]),
                float(p["a2"] + sign * p["b2"]),
                float(p["a3"] + sign * p["b3"]),
                self._radius,
                start,
            )
            for sign, start in zip((-1.0, 1.0), place, strict=True)
        )
        self.since = machine.now * US
        self._blocked = False
        machine.motors.listeners.append(self._drive)
        self._drive(machine.now, *machine.motors.duties)
        for number, encoder in enumerate(machine.encoders):
            encoder.angle = lambda now, number=number: self.angles(now)[number]

    def _drive(self, now: float, *duties: float) -> None:
        """Apply duties to the motors from `now` [us] on."""
        self._settle(now)
        first, second = (duty * self._supply for duty in duties)
        for axis, volts in zip(self.axes, (first - second, -first - second), strict=True):
            axis.volts = 0.0 if self._blocked else volts

    def _settle(self, now: float) -> None:
        seconds = now * US - self.since
        for axis in self.axes:
            axis.rest, axis.slow, axis.fast = axis.after(seconds)
        self.since = now * US

    def place(self, now: float) -> tuple[float, float]:
        """The mallet's place [m] at `now` [us], a time not before the last change of voltage."""
        x, y = (sum(axis.after(now * US - self.since)) for axis in self.axes)
        return x, y

    def velocity(self, now: float) -> tuple[float, float]:
        """The mallet's velocity [m/s] at `now` [us]."""
        x, y = (axis.velocity_after(now * US - self.since) for axis in self.axes)
        return x, y

    def angles(self, now: float) -> tuple[float, float]:
        """The shafts' angles [rad] at `now` [us], as their encoders measure them."""
        x, y = self.place(now)
        return (x - y) / self._radius + self._zero[0], (-x - y) / self._radius + self._zero[1]

    def block(self, now: float) -> None:
        """Block the mallet at its place from `now` [us] on."""
        self._settle(now)
        self._blocked = True
        for axis in self.axes:
            axis.rest, axis.slow, axis.fast, axis.volts = axis.rest + axis.slow + axis.fast, 0.0, 0.0, 0.0
