"""The board's configuration for a table: gantry, limits and gains."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from puckpilot_env.game import mirror
from puckpilot_env.physics.gantry.mallet import axis_coefficients
from sim2real.link.wire.messages import LIMITS, Config
from sim2real.table.mallet_driver import operating_volts

OFF_PATH = 0.05  # m from its path at which the board stops the mallet
US = 1e-6  # s
MOST_COMMAND_DELAY = US * LIMITS[Config]["command_delay"][1]  # s
SILENCE = 12  # ms without a message after which the board stops: then it has 37 ms left to brake within 50 ms


@dataclass(frozen=True)
class Gains:
    """The board's feedback on axes x and y: proportional [V/m], integral [V/m/s], derivative [V s/m]."""

    proportional: tuple[float, float] = (400.0, 400.0)
    integral: tuple[float, float] = (500.0, 500.0)
    derivative: tuple[float, float] = (2.0, 2.0)


def board_config(p: np.void, gains: Gains | None = None, command_delay: float = 0.0) -> Config:
    """The configuration for a table of these parameters, whose motors obey `command_delay` [s] late. ValueError, in one
    line, for a longer delay than a board allows for."""
    if not 0.0 <= command_delay <= MOST_COMMAND_DELAY:
        raise ValueError(f"command_delay is {command_delay:g} s; expected 0 to {MOST_COMMAND_DELAY:g}")
    gains = gains or Gains()
    x_low, x_high, y_low, y_high = mirror.area(0, p)  # the board stops a mallet that is 5 mm beyond
    (c5x, c6x, c7x), (c5y, c6y, c7y) = axis_coefficients(p, 0), axis_coefficients(p, 1)
    return Config(
        (c5x, c5y), (c6x, c6y), (c7x, c7y), float(p["pulley_radius"]), float(p["max_voltage"]), operating_volts(p),
        (x_low, x_high), (y_low, y_high),
        gains.proportional, gains.integral, gains.derivative, OFF_PATH, SILENCE, round(command_delay / US),
    )  # fmt: skip
