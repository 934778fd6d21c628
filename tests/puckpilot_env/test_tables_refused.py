"""Batches that cannot be: sizes, draws and gantries are refused in words that say what was expected."""

from __future__ import annotations

from dataclasses import replace

import pytest

from puckpilot_env import Tables, find_variant
from puckpilot_env.randomization import Draw


@pytest.mark.parametrize(
    "options, told",
    [
        ({"tables": 0}, "tables is 0; expected a whole number from 1"),
        ({"threads": 0}, "threads is 0; expected a whole number from 1 to 256"),
        ({"period": 0.008}, "period is 0.008; expected a number of seconds from 1/120 to 1"),
        ({"max_cycles": 0}, "limit of steps is 0; expected a whole number from 1"),
        ({"seed": -1}, r"seed is -1; expected a whole number from 0 to 2\*\*64 - 1"),
        ({"variant": "mach-v0"}, "unknown variant 'mach-v0'; did you mean 'puckpilot/match-v0'?"),
    ],
)
def test_what_cannot_be_is_refused(options, told):
    with pytest.raises(ValueError, match=told.replace("?", r"\?")):
        Tables(**{"variant": "match-v0", "tables": 1, **options})


@pytest.mark.parametrize(
    "draw, told",
    [
        (
            Draw("drag", "log-uniform", 0.0, 0.2, ""),
            "log-uniform from 0; expected low > 0",
        ),
        (Draw("drag", "uniform", 0.2, 0.1, ""), "draw of 'drag' is from 0.2 to 0.1; expected low <= high"),
        (Draw("drag", "normal", 0.1, 0.2, ""), "unknown distribution 'normal'"),
    ],
)
def test_draws_that_cannot_be_are_refused(draw, told):
    with pytest.raises(ValueError, match=told):
        Tables(replace(find_variant("match-v0"), draws=(draw,)), 1)


def test_a_spread_that_makes_a_gantry_swing_is_refused():
    """Poles are real as long as C6^2 > 4 C5 C7, for the worst of the drawn coefficients too."""
    slow = {"a1": 3e-4, "b1": 0.0}  # y: C6^2 / (4 C5 C7) = 0.138; x likewise 1.12
    with pytest.raises(ValueError, match="not overdamped"):
        Tables("match-v0", 1, parameters=slow)
    nearly = {"a1": 3e-5, "b1": 0.0}  # y: 1.38, and with 20 % of spread 0.61
    Tables("match-v0", 1, parameters=nearly)
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables("match-v0", 1, parameters={**nearly, "gantry_spread": 0.2})
    drawn = replace(find_variant("match-v0"), draws=(Draw("gantry_spread", "uniform", 0.0, 0.2, ""),))
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables(drawn, 1, parameters=nearly)
