"""Every physical number of the simulator: name, unit, default, range and where it comes from, once.

The rows below, and those that each effect brings along (`physics/effects/`), are the only place where a default
stands. `RECORD` is the numpy layout in which the kernels read
them (one float64 field a row), so a set of parameters is always addressed by name, never by position.
"""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from itertools import product

import numpy as np

from puckpilot_env.effect import Parameter
from puckpilot_env.options.inputs import in_short, real_number
from puckpilot_env.physics.effects import EFFECTS

_CHOICE = "not in the report; a documented choice (errata, last row)"
_FRAMES = "0 to 7 % in recordings of a real table"
_E2 = "report, appendix E.2"
# Of a gantry with all volts on one axis, and how much of each can be simulated: a place is a sum of modes, of which the
# slow one may be rounded by a picometre, and the fast one keeps the mallet off the rails
_OF_A_GANTRY = ("top speed", "acceleration", "slow mode", "fast mode")
_MOST_OF_A_GANTRY = (50.0, 1e4, 1e4, 5e-3)
_UNITS_OF_A_GANTRY = ("m/s", "m/s^2", "m", "m")

NOT_SIMULATED = {
    row.name: (name, e.not_simulated) for name, e in EFFECTS.items() if e.not_simulated for row in e.rows.values()
}
UNLISTED = {row.name: name for name, effect in EFFECTS.items() if not effect.listed for row in effect.rows.values()}
EFFECT_ROWS = tuple(row for effect in EFFECTS.values() for row in effect.rows.values())

TABLE: tuple[Parameter, ...] = (
    Parameter(
        "length", "m", 2.0, 1.0, 4.0, "table length, x from the robot's end to the opponent's", "report, appendix J"
    ),
    Parameter("width", "m", 1.0, 0.5, 2.0, "table width, y from the robot's right to its left", _CHOICE),
    Parameter("goal_width", "m", 0.32, 0.1, 0.45, "width of the goal mouth, centred on the short walls", _CHOICE),
    Parameter("puck_radius", "m", 0.0309, 0.01, 0.045, "puck radius", "report, appendix C.2.3"),
    Parameter("mallet_radius", "m", 0.0505, 0.02, 0.1, "mallet radius", _CHOICE),
    Parameter(
        "friction", "m/s^2", 0.125, 0.0, 5.0, "sliding friction per unit mass, f/m", "report, appendix F.2 (ratio)"
    ),
    Parameter("drag", "1/m", 0.125, 0.0, 5.0, "quadratic drag per unit mass, B/m", "report, appendix F.2 (ratio)"),
    Parameter("wall_restitution", "1", 0.7, 0.0, 1.0, "speed kept at walls and posts, both components", "report, F.3"),
    Parameter("mallet_restitution", "1", 0.7, 0.0, 1.0, "normal restitution against a mallet", _CHOICE),
    Parameter("pulley_radius", "m", 0.035306, 0.005, 0.2, "gantry pulley radius R", _E2),
    Parameter("max_voltage", "V", 24.0, 1.0, 60.0, "supply: |V_x| + |V_y| <= 2 max_voltage", "report, section 2.3.1"),
    Parameter(
        "braking_time",
        "s",
        0.0,
        0.0,
        1.0,
        "plans can be braked to rest within it at any moment, as a table's board asks (0.034); 0: any plan",
        _CHOICE,
    ),
    Parameter(
        "feedback_voltage",
        "V",
        0.0,
        0.0,
        6.0,
        "of feedback at each motor, beyond a plan's, against friction and sag, as a table's board has (1); 0: none",
        _CHOICE,
    ),
    Parameter(
        "observation_age",
        "s",
        0.0,
        0.0,
        0.06,
        "exact observations are so old, at most a step, and predicted on, as at a table (0.0205); 0: as it is",
        _CHOICE,
    ),
    Parameter(
        "hand",
        "1",
        0.0,
        0.0,
        1.0,
        "1: player 1's mallet is in a hand, which effects of mallets, gantry, braking_time, observation_age spare",
        _CHOICE,
        whole=True,
    ),
    Parameter("a1", "V s^3", 3.579e-6, 1e-9, 1e-3, "own-motor jerk coefficient a1", _E2),
    Parameter("a2", "V s^2", 0.00571, 1e-5, 1.0, "own-motor acceleration coefficient a2", _E2),
    Parameter("a3", "V s", 0.05315, 1e-4, 10.0, "own-motor speed coefficient a3", _E2),
    Parameter("b1", "V s^3", -1.7165e-6, -1e-3, 1e-3, "other-motor jerk coefficient b1", _E2),
    Parameter("b2", "V s^2", -0.002739, -1.0, 1.0, "other-motor acceleration coefficient b2", _E2),
    Parameter("b3", "V s", 0.0, -10.0, 10.0, "other-motor speed coefficient b3", _E2),
    Parameter("gantry_spread", "1", 0.0, 0.0, 0.3, "each player's C5, C6, C7 differ by up to this share", _CHOICE),
    Parameter("frame_rate", "Hz", 120.0, 10.0, 300.0, "camera frames a second", "camera of the real table"),
    Parameter(
        "camera_latency", "s", 0.0134, 0.0, 0.06, "from exposure to a usable position", "measured on the real table"
    ),
    Parameter(
        "frame_jitter",
        "s",
        0.0,
        0.0,
        0.002,
        "spread of a frame's exposure about its regular time",
        "0.08 to 0.27 ms in the stamps of a real camera",
    ),
    Parameter("camera_noise", "m", 0.0002, 0.0, 0.02, "white noise of a position", "measured on the real table"),
    Parameter("beam_noise", "m", 0.0006, 0.0, 0.02, "white noise near the gantry beam", "measured on the real table"),
    Parameter("beam_width", "m", 0.04, 0.0, 0.2, "width of the gantry beam over each mallet", _CHOICE),
    Parameter("camera_error", "m", 0.001, 0.0, 0.02, "rms of the smooth position-dependent error", "report, 2.2.2"),
    Parameter("dropped_frames", "1", 0.01, 0.0, 0.9, "share of frames without a position", _FRAMES),
    Parameter("held_frames", "1", 0.02, 0.0, 0.9, "share of frames that repeat the one before", _FRAMES),
    Parameter("action_noise", "1", 0.0, 0.0, 0.5, "relative noise of both voltages, drawn at each action", _CHOICE),
    Parameter("impulse_rate", "1/s", 0.0, 0.0, 10.0, "random impulses on the puck", "report, K.2 (named, no number)"),
    Parameter("impulse_speed", "m/s", 0.1, 0.0, 2.0, "size of a random impulse, each component", _CHOICE),
    *EFFECT_ROWS,
)

BY_NAME: dict[str, Parameter] = {row.name: row for row in TABLE}
RECORD = np.dtype([(row.name, np.float64) for row in TABLE])
COLUMN: dict[str, int] = {row.name: index for index, row in enumerate(TABLE)}


def make_records(tables: int, values: Mapping[str, float] | None = None) -> np.ndarray:
    """`(tables,)` records of the defaults, with `values` [SI units] put in their place by name.

    Raises ValueError for an unknown name, a value out of its range, or numbers that do not make a table together.
    """
    records = np.zeros(tables, RECORD)
    for row in TABLE:
        records[row.name] = row.default
    for name, value in (values or {}).items():
        records[name] = checked(name, value)
    if tables:
        check_together(records[0])
    return records


def without_effects(records: np.ndarray) -> np.ndarray:
    """A copy of the records with every effect off."""
    records = records.copy()
    for row in EFFECT_ROWS:
        records[row.name] = row.default
    return records


def as_matrix(records: np.ndarray) -> np.ndarray:
    """The same memory as a float64 `(tables, len(TABLE))` array; column i is TABLE[i]."""
    return records.view(np.float64).reshape(len(records), len(TABLE))


def checked(name: str, value: object) -> float:
    """`value` as a float if `name` is a parameter and it lies in its range; otherwise ValueError, for texts and truth
    values too."""
    if name not in BY_NAME:
        near = difflib.get_close_matches(str(name), BY_NAME, n=1)
        hint = (
            f"; did you mean '{near[0]}'?"
            if near
            else f"; known: {', '.join(row.name for row in TABLE if row not in EFFECT_ROWS)}"
        )
        raise ValueError(f"unknown parameter {in_short(name)}{hint}")
    row = BY_NAME[name]
    number = real_number(value)
    if not row.low <= number <= row.high or (row.whole and number != int(number)):
        what = "a whole number" if row.whole else "a number"
        unit = "" if row.unit == "1" else f" {row.unit}"
        raise ValueError(
            f"parameter '{name}' is {in_short(value)}; expected {what} in [{row.low:g}, {row.high:g}]{unit}"
        )
    return number


def refuse_not_simulated(values: Mapping[str, float]) -> None:
    """ValueError, in one line, for a value that switches on an effect that no table can be given."""
    for name, value in values.items():
        if name in NOT_SIMULATED and value != BY_NAME[name].default:
            effect, reason = NOT_SIMULATED[name]
            raise ValueError(f"no table can be given {effect}: {reason}; leave it out")


def check_together(record: np.void) -> None:
    """ValueError, in one line, if numbers that are each in their range do not make a table together."""
    if record["goal_width"] + 2 * record["puck_radius"] > record["width"]:
        raise ValueError("goal_width leaves no wall beside the mouth; expected goal_width + 2 puck_radius <= width")
    if record["goal_width"] <= 2 * record["puck_radius"]:
        raise ValueError("the puck does not fit through the goal; expected goal_width > 2 puck_radius")
    if record["width"] < 6 * record["mallet_radius"] or record["length"] < 14 * (
        record["mallet_radius"] + record["puck_radius"]
    ):  # then puck and mallet do not overlap in any start
        raise ValueError("the table is too small: expected width >= 6 mallet radii, length >= 14 of mallet and puck")
    for name, effect in EFFECTS.items():
        if effect.listed:
            continue
        reason = effect.misfit({short: float(record[row.name]) for short, row in effect.rows.items()})
        if reason:
            raise ValueError(f"{name} cannot be simulated: {reason}")
    for sign, axis in ((-1.0, "x"), (1.0, "y")):
        c5, c6, c7 = (float(record[f"a{i}"] + sign * record[f"b{i}"]) for i in (1, 2, 3))
        spread = float(record["gantry_spread"])
        if not (c5 > 0 and c6 > 0 and c7 > 0 and (1 - spread) ** 2 * c6 * c6 > (1 + spread) ** 2 * 4 * c5 * c7):
            raise ValueError(
                f"gantry axis {axis} is not overdamped: C5, C6, C7 = {c5:g}, {c6:g}, {c7:g}, each up to {spread:g} of "
                "itself off; change a, b or gantry_spread"
            )
        drive = float(record["pulley_radius"] * record["max_voltage"])  # half the radius, and twice the voltage
        found = _extremes(c5, c6, c7, spread, drive)
        for what, value, most, unit in zip(_OF_A_GANTRY, found, _MOST_OF_A_GANTRY, _UNITS_OF_A_GANTRY, strict=True):
            if value > most:
                raise ValueError(
                    f"gantry axis {axis} cannot be simulated: its {what} is {value:.3g} {unit} with all volts; "
                    f"expected at most {most:g}: change a, b, gantry_spread, pulley_radius or max_voltage"
                )


def _extremes(c5: float, c6: float, c7: float, spread: float, drive: float) -> tuple[float, float, float, float]:
    """The numbers `_OF_A_GANTRY` of an axis whose coefficients are each up to `spread` of themselves off.

    `drive` [V m]: half the pulley's radius times all volts. The modes are those of `physics.mallet.axis_constants`.
    """
    found = []
    for s5, s6, s7 in product((1.0 - spread, 1.0 + spread), repeat=3):
        jerk, force, drag = s5 * c5, s6 * c6, s7 * c7
        fast = (force + math.sqrt(force * force - 4.0 * jerk * drag)) / (2.0 * jerk)
        slow = drag / (jerk * fast)
        acceleration = drive / (jerk * (fast - slow))  # of either mode alone
        found.append((drive / drag, acceleration, acceleration / slow**2, acceleration / fast**2))
    return tuple(max(column) for column in zip(*found, strict=True))  # pyright: ignore[reportReturnType] - four columns
