"""How tables differ from each other: named distributions with their measured source."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env import parameters
from puckpilot_env.game.start import LOG_UNIFORM, UNIFORM

DISTRIBUTIONS = {"uniform": UNIFORM, "log-uniform": LOG_UNIFORM}


@dataclass(frozen=True)
class Draw:
    """A parameter that every table draws anew for each episode, and why in this range."""

    parameter: str
    distribution: str
    low: float
    high: float
    source: str = field(compare=False)  # another reason makes no other table


_LEVEL = "0.05 degrees (0.0086 m/s^2) found on a real table"
_WARP = "fitted to a real table (test_real_table.py, play_a); a bowl there, a hump elsewhere"
_BOUNCES = "fitted to a real table's bounces (test_real_table.py, play_a)"
_STATED = "calibrations of a real table find its stated width 2.6 mm off (README, On a real table)"

REALITY: tuple[Draw, ...] = (
    Draw("friction", "log-uniform", 0.006, 0.25, "0.006 to 0.009 fitted on a real table, to twice report F.2"),
    Draw("drag", "log-uniform", 0.014, 0.25, "0.02 fitted on a real table, to twice report F.2"),
    Draw("wall_restitution", "uniform", 0.65, 0.9, "report F.3 (0.7) and a real table (0.83 to 0.86)"),
    Draw("mallet_restitution", "uniform", 0.45, 0.9, "0.49 kept by the mallet on a real table; above it a choice"),
    Draw("gantry_spread", "uniform", 0.0, 0.1, "spread of gantry fits between voltages; a choice"),
    Draw("camera_noise", "uniform", 0.00015, 0.0003, "0.2 mm measured on the real table"),
    Draw("beam_noise", "uniform", 0.0004, 0.0008, "0.6 mm measured on the real table near the beam"),
    Draw("camera_error", "uniform", 0.0005, 0.0015, "about 1 mm, report 2.2.2"),
    Draw("dropped_frames", "uniform", 0.0, 0.07, "no puck in 0 to 7 % of the frames of a real table"),
    Draw("held_frames", "uniform", 0.0, 0.07, "0 to 7 % of the frames of a real table repeat the one before"),
    Draw("action_noise", "uniform", 0.0, 0.05, "supply under load; a choice"),
    Draw("impulse_rate", "uniform", 0.0, 0.2, "report K.2 names them without a number"),
    Draw(
        "camera_latency",
        "uniform",
        0.007,
        0.02,
        "8.0 ms (7.2 to 8.7) diagnosed in play_a, 13.4 ms measured; above: choice",
    ),
    Draw("frame_jitter", "uniform", 0.0, 0.0003, "stamps of a real camera scatter by 0.08 to 0.27 ms (play_a, puck_a)"),
    Draw("command_delay", "uniform", 0.0005, 0.005, "line at 1 MBd and tick of 1 ms (firmware/); up to a choice"),
    Draw("voltage_sag", "uniform", 0.0, 0.011, "what the logs of a real gantry allow (test_gantry.py, hold_no_sag)"),
    Draw("motor_deadband", "uniform", 0.0, 0.75, "friction of 0.55 V a motor, 0.75 V an axis in real logs"),
    Draw("tilt_x", "uniform", -0.017, 0.017, f"{_LEVEL}, twice that either way"),
    Draw("tilt_y", "uniform", -0.017, 0.017, f"{_LEVEL}, twice that either way"),
    Draw("warp_xx", "uniform", -0.1, 0.1, f"-0.009 {_WARP}"),
    Draw("warp_yy", "uniform", -0.1, 0.1, f"0.089 {_WARP}"),
    Draw("warp_xy", "uniform", -0.1, 0.1, f"0.056 {_WARP}"),
    Draw("wall_mu", "uniform", 0.05, 0.2, f"0.115 (0.095 to 0.135) {_BOUNCES}"),
    Draw("spin_inertia", "uniform", 0.3, 1.0, f"0.66 (0.28 to 1.0) {_BOUNCES}; 1/2 is a full disc, 1 a ring"),
    Draw("spin_decay", "uniform", 0.0, 0.9, f"0.0 (0.0 to 0.90) {_BOUNCES}"),
    Draw("restitution_slope", "uniform", 0.0, 0.03, f"0.0166 (0.011 to 0.022) {_BOUNCES}"),
    Draw("length", "uniform", 1.997, 2.003, _STATED),
    Draw("width", "uniform", 0.997, 1.003, _STATED),
)


def typical(draw: Draw) -> float:
    """The median of what is drawn."""
    return math.sqrt(draw.low * draw.high) if draw.distribution == "log-uniform" else 0.5 * (draw.low + draw.high)


def as_rows(draws: tuple[Draw, ...]) -> np.ndarray:
    """`(draws, 4)` float64 for the kernels: column of the parameter, kind of distribution, low, high.

    Raises ValueError, in one line, for a parameter or distribution that does not exist, a range that the parameter
    cannot have, or an effect that no table can be given.
    """
    rows = np.zeros((len(draws), 4))
    for row, draw in zip(rows, draws, strict=True):
        if draw.distribution not in DISTRIBUTIONS:
            known = ", ".join(DISTRIBUTIONS)
            raise ValueError(
                f"the draw of '{draw.parameter}' has the unknown distribution '{draw.distribution}'; known: {known}"
            )
        if draw.parameter in parameters.UNLISTED:
            law = parameters.UNLISTED[draw.parameter]
            raise ValueError(
                f"'{draw.parameter}' cannot be drawn: it is one of a table of numbers of {law}; give an effects file"
            )
        low, high = parameters.checked(draw.parameter, draw.low), parameters.checked(draw.parameter, draw.high)
        parameters.refuse_not_simulated({draw.parameter: low} | ({draw.parameter: high} if high != low else {}))
        if low > high:
            raise ValueError(f"the draw of '{draw.parameter}' is from {low:g} to {high:g}; expected low <= high")
        if draw.distribution == "log-uniform" and low <= 0.0:
            raise ValueError(f"the draw of '{draw.parameter}' is log-uniform from {low:g}; expected low > 0")
        row[:] = parameters.COLUMN[draw.parameter], DISTRIBUTIONS[draw.distribution], low, high
    return rows
