"""Every physical number of the simulator: name, unit, default, range and where it comes from, once.

The rows below are the only place where a default stands. `Record` is the numpy layout in which the kernels read
them (one float64 field a row), so a set of parameters is always addressed by name, never by position.
"""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np


@dataclass(frozen=True)
class Parameter:
    """One physical number. `low` and `high` bound what the simulator accepts; `default` is what a table has."""

    name: str
    unit: str
    default: float
    low: float
    high: float
    meaning: str
    source: str


_R = "report"
_CHOICE = "not in the report; a documented choice (errata, last row)"
_E2 = "report, appendix E.2"

TABLE: tuple[Parameter, ...] = (
    Parameter("length", "m", 2.0, 1.0, 4.0, "table length, x from the robot's end to the opponent's", "report, appendix J"),
    Parameter("width", "m", 1.0, 0.5, 2.0, "table width, y from the robot's right to its left", _CHOICE),
    Parameter("goal_width", "m", 0.32, 0.1, 0.45, "width of the goal mouth, centred on the short walls", _CHOICE),
    Parameter("puck_radius", "m", 0.0309, 0.01, 0.045, "puck radius", "report, appendix C.2.3"),
    Parameter("mallet_radius", "m", 0.0505, 0.02, 0.1, "mallet radius", _CHOICE),
    Parameter("friction", "m/s^2", 0.125, 0.0, 5.0, "sliding friction per unit mass, f/m", "report, appendix F.2 (ratio)"),
    Parameter("drag", "1/m", 0.125, 0.0, 5.0, "quadratic drag per unit mass, B/m", "report, appendix F.2 (ratio)"),
    Parameter("wall_restitution", "1", 0.7, 0.0, 1.0, "speed kept at walls and posts, both components", "report, F.3"),
    Parameter("mallet_restitution", "1", 0.7, 0.0, 1.0, "normal restitution against a mallet", _CHOICE),
    Parameter("pulley_radius", "m", 0.035306, 0.005, 0.2, "gantry pulley radius R", _E2),
    Parameter("max_voltage", "V", 24.0, 1.0, 60.0, "supply: |V_x| + |V_y| <= 2 max_voltage", "report, section 2.3.1"),
    Parameter("a1", "V s^3", 3.579e-6, 1e-9, 1e-3, "own-motor jerk coefficient a1", _E2),
    Parameter("a2", "V s^2", 0.00571, 1e-5, 1.0, "own-motor acceleration coefficient a2", _E2),
    Parameter("a3", "V s", 0.05315, 1e-4, 10.0, "own-motor speed coefficient a3", _E2),
    Parameter("b1", "V s^3", -1.7165e-6, -1e-3, 1e-3, "other-motor jerk coefficient b1", _E2),
    Parameter("b2", "V s^2", -0.002739, -1.0, 1.0, "other-motor acceleration coefficient b2", _E2),
    Parameter("b3", "V s", 0.0, -10.0, 10.0, "other-motor speed coefficient b3", _E2),
)
