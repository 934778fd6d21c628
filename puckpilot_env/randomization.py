"""How tables differ from each other: named distributions with their measured source."""

from __future__ import annotations

from dataclasses import dataclass

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
    source: str


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
)


def as_rows(draws: tuple[Draw, ...]) -> np.ndarray:
    """`(draws, 4)` float64 for the kernels: column of the parameter, kind of distribution, low, high.

    Raises ValueError for a parameter or distribution that does not exist, or a range that the parameter cannot have.
    """
    rows = np.zeros((len(draws), 4))
    for row, draw in zip(rows, draws, strict=True):
        if draw.distribution not in DISTRIBUTIONS:
            raise ValueError(f"unknown distribution '{draw.distribution}'; known: {', '.join(DISTRIBUTIONS)}")
        low, high = parameters.checked(draw.parameter, draw.low), parameters.checked(draw.parameter, draw.high)
        if low > high:
            raise ValueError(f"the draw of '{draw.parameter}' is from {low:g} to {high:g}; expected low <= high")
        if draw.distribution == "log-uniform" and low <= 0.0:
            raise ValueError(f"the draw of '{draw.parameter}' is log-uniform from {low:g}; expected low > 0")
        row[:] = parameters.COLUMN[draw.parameter], DISTRIBUTIONS[draw.distribution], low, high
    return rows
