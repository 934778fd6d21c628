"""Whether tables can be drawn at all: every combination that may occur must be a table, and one that players can play.

Each condition is a comparison that a parameter moves in one direction only, whatever the others are. What holds at all
corners of the box of the parameters involved therefore holds everywhere in it.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import product

import numpy as np

from puckpilot_env.game.observation import BEYOND
from puckpilot_env.options.randomization import Draw
from puckpilot_env.parameters import check_together

SIZES = ("length", "width", "goal_width", "puck_radius", "mallet_radius")
COEFFICIENTS = ("a1", "a2", "a3", "b1", "b2", "b3")
TOGETHER = (SIZES, (*COEFFICIENTS, "gantry_spread"))  # each group's numbers make a table together
SHOWN = ("length", "width")


def check_draws(draws: Sequence[Draw], nominal: np.void, *, period: float, shows_gantry: bool) -> None:
    """ValueError, in one line, if some table that may be drawn about the `nominal` parameters cannot be played.

    Orders must come before the next ones are given, `period` [s] later. And nothing may be drawn that a variant
    discloses, which are the numbers that its observations are measured in, so that what is shown would be false of the
    table: where it shows gantries, the coefficients that the shown shares are of; and lengths and widths farther off
    the nominal ones than the observation's bounds reach. Other numbers players may know, and find a little wrong.
    """
    drawn = {draw.parameter: draw for draw in draws}
    for name in COEFFICIENTS if shows_gantry else ():
        if name in drawn:
            raise ValueError(
                f"{name} cannot be drawn: players are shown their gantry's coefficients as shares of it; "
                "draw gantry_spread, or give it as a parameter"
            )
    for name in SHOWN:
        usual = float(nominal[name])
        if name in drawn and max(usual - drawn[name].low, drawn[name].high - usual) > BEYOND + 1e-9:
            raise ValueError(
                f"the draw of '{name}' is from {drawn[name].low:g} to {drawn[name].high:g}; expected within {BEYOND:g} "
                f"m of the nominal {usual:g}, beyond which nothing is seen; give another nominal one as a parameter"
            )
    late = max(float(nominal["command_delay"]), drawn["command_delay"].high if "command_delay" in drawn else 0.0)
    if late >= period:
        raise ValueError(f"command_delay is {late:g} s; expected less than the period of {period:g} s")
    for names in TOGETHER:
        _check_corners([drawn[name] for name in names if name in drawn], nominal)


def _check_corners(draws: Sequence[Draw], nominal: np.void) -> None:
    for corner in product(*((draw.low, draw.high) for draw in draws)):
        extreme = nominal.copy()
        for draw, value in zip(draws, corner, strict=True):
            extreme[draw.parameter] = value
        try:
            check_together(extreme)
        except ValueError as error:
            where = ", ".join(f"{draw.parameter} {value:g}" for draw, value in zip(draws, corner, strict=True))
            raise ValueError(f"{error}; drawn are {where}" if draws else str(error)) from None
