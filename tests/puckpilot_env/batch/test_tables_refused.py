"""Batches that cannot be: sizes, draws and gantries are refused in words that say what was expected."""

from __future__ import annotations

import math
import re
from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env import Tables, find_variant
from puckpilot_env.options.randomization import Draw


@pytest.mark.parametrize(
    "options, expected",
    [
        ({"tables": 0}, "tables is 0; expected a whole number from 1"),
        ({"threads": 0}, "threads is 0; expected a whole number from 1 to 256"),
        ({"tables": True}, "tables is True; expected a whole number from 1 to 1,000,000"),
        ({"tables": 2.0}, "tables is 2.0; expected a whole number"),
        ({"tables": "2"}, "tables is '2'; expected a whole number"),
        ({"tables": 10**5000}, "tables is a int; expected a whole number"),
        ({"threads": np.bool_(True)}, "threads is True; expected a whole number"),
        ({"threads": [2]}, "threads is [2]; expected a whole number"),
        ({"autoreset": 1}, "autoreset is 1; expected True or False"),
        ({"autoreset": None}, "autoreset is None; expected True or False"),
        ({"period": 0.008}, "period is 0.008; expected a number of seconds from 1/120 to 1"),
        ({"period": math.nan}, "period is nan; expected a number of seconds"),
        ({"period": True}, "period is True; expected a number of seconds"),
        ({"period": "0.1"}, "period is '0.1'; expected a number of seconds"),
        ({"period": 10**400}, "period is 10000"),
        ({"max_cycles": 0}, "max_cycles is 0; expected a whole number from 1"),
        ({"max_cycles": True}, "max_cycles is True; expected a whole number from 1"),
        ({"seed": -1}, "seed is -1; expected a whole number from 0 to 2**64 - 1"),
        ({"seed": np.int64(-1)}, "seed is -1; expected a whole number from 0 to 2**64 - 1"),
        ({"seed": 2**64}, "seed is 18446744073709551616; expected"),
        ({"seed": None}, "seed is None; expected a whole number"),
        ({"seed": False}, "seed is False; expected a whole number"),
        ({"seed": 1.0}, "seed is 1.0; expected a whole number"),
        ({"seed": [1, 2]}, "seed is [1, 2]; expected a whole number"),
        ({"variant": "mach-v0"}, "unknown variant 'mach-v0'; did you mean 'puckpilot/match-v0'?"),
        ({"variant": None}, "variant is None; expected an id such as 'match-v0', or a Variant"),
        ({"variant": 3}, "variant is 3; expected an id"),
        ({"parameters": 3}, "parameters is 3; expected a dict, as in {'friction': 0.1}"),
        ({"parameters": ["friction"]}, "parameters is ['friction']; expected a dict"),
        ({"parameters": {3: 0.1}}, "unknown parameter 3; "),
        ({"parameters": {"friction": 10**400}}, "parameter 'friction' is 1000"),
        ({"parameters": {"friction": math.nan}}, "parameter 'friction' is nan; expected a number in [0, 5] m/s^2"),
        ({"parameters": {"friction": True}}, "parameter 'friction' is True; expected a number in"),
        ({"parameters": {"friction": "0.1"}}, "parameter 'friction' is '0.1'; expected a number in"),
        ({"parameters": {"friction": [0.1, 0.2]}}, "parameter 'friction' is [0.1, 0.2]; expected a number in"),
        ({"parameters": {"friction": np.zeros((40, 40))}}, "parameter 'friction' is array([[0., 0., 0."),
        ({"parameters": {"friction": 1 + 0j}}, "parameter 'friction' is (1+0j); expected a number in"),
        ({"parameters": {"command_delay": "0.1"}}, "parameter 'command_delay' is '0.1'; expected a number in"),
        ({"effects": 3}, "effects is 3; expected a dict, as in {'table_tilt': {'tilt_x': 0.02}}, or a file"),
        ({"effects": ["table_tilt"]}, "effects is ['table_tilt']; expected a dict"),
        ({"effects": {"table_tilt": 3}}, "effects.table_tilt is 3; expected numbers by name"),
        ({"effects": {3: {"tilt_x": 0.1}}}, "unknown effect '3'; known:"),
        ({"effects": {"table_tilt": {"tilt_x": 10**400}}}, "is 1000"),
    ],
)
def test_what_cannot_be_is_refused(options, expected):
    with pytest.raises(ValueError, match=re.escape(expected)) as caught:
        Tables(**{"variant": "match-v0", "tables": 1, **options})
    assert "\n" not in str(caught.value) and re.search("; (expected|did you mean|known)", str(caught.value))


@pytest.mark.parametrize(
    "options",
    [
        {"tables": np.int32(2), "threads": np.uint8(2), "seed": np.uint64(2**64 - 1), "max_cycles": np.int16(9)},
        {"period": np.float32(0.1), "parameters": {"friction": np.float32(0.25), "goal_width": np.int64(0) + 0.4}},
        {"autoreset": np.bool_(False), "period": 1, "parameters": {"impulse_rate": 2}},
    ],
)
def test_numbers_of_numpy_are_taken(options):
    tables = Tables(**{"variant": "match-v0", "tables": 1, **options})
    for name, value in options.get("parameters", {}).items():
        assert (tables.params[name] == value).all()
    tables.close()


@pytest.mark.parametrize(
    "draw, expected",
    [
        (
            Draw("drag", "log-uniform", 0.0, 0.2, ""),
            "log-uniform from 0; expected low > 0",
        ),
        (Draw("drag", "uniform", 0.2, 0.1, ""), "draw of 'drag' is from 0.2 to 0.1; expected low <= high"),
        (Draw("drag", "normal", 0.1, 0.2, ""), "unknown distribution 'normal'"),
    ],
)
def test_draws_that_cannot_be_are_refused(draw, expected):
    with pytest.raises(ValueError, match=expected):
        Tables(replace(find_variant("match-v0"), draws=(draw,)), 1)


def test_a_spread_that_makes_a_gantry_swing_is_refused():
    """Poles are real as long as C6^2 > 4 C5 C7, for the worst of the drawn coefficients too."""
    slow = {"a1": 1e-3, "b1": 0.0}  # y: C6^2 / (4 C5 C7) = 0.042; x likewise 0.34
    with pytest.raises(ValueError, match="not overdamped"):
        Tables("match-v0", 1, parameters=slow)
    weak = {"max_voltage": 1.0, "pulley_radius": 0.005}  # its fast modes, which are slow ones, stay small
    nearly = {"a1": 3e-5, "b1": 0.0, **weak}  # y: 1.38, and with 20 % of spread 0.61
    Tables("match-v0", 1, parameters=nearly)
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables("match-v0", 1, parameters={**nearly, "gantry_spread": 0.2})
    drawn = replace(find_variant("match-v0"), draws=(Draw("gantry_spread", "uniform", 0.0, 0.2, ""),))
    with pytest.raises(ValueError, match=r"gantry axis y is not overdamped.*gantry_spread"):
        Tables(drawn, 1, parameters=nearly)
