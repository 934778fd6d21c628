"""Parameters: by name, in their ranges, and refused in one line where they make no table."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env import Tables, parameters

# What the report and the errata give, by hand.
STATED = {
    "length": 2.0,
    "width": 1.0,
    "goal_width": 0.32,
    "puck_radius": 0.0309,
    "mallet_radius": 0.0505,
    "friction": 0.125,
    "drag": 0.125,
    "wall_restitution": 0.7,
    "max_voltage": 24.0,
    "frame_rate": 120.0,
    "camera_noise": 0.0002,
    "beam_noise": 0.0006,
    "camera_error": 0.001,
}
ROWS = {row.name: row for row in parameters.TABLE}


def test_defaults_are_the_stated_numbers():
    record = parameters.make_records(1)[0]
    for name, value in STATED.items():
        assert record[name] == value, name
    for row in parameters.TABLE:
        assert record[row.name] == row.default and row.low <= row.default <= row.high, row.name
        assert row.unit and row.meaning and row.source, row.name
    assert len(ROWS) == len(parameters.TABLE)


def test_gantry_poles_are_those_of_the_errata():
    """C5 p''' + C6 p'' + C7 p' = (R/2) V with C = a - b for x and a + b for y; poles as in the errata's first row."""
    p = parameters.make_records(1)[0]
    for sign, poles in ((-1.0, (-1589.0, -6.3)), (1.0, (-1577.0, -18.1))):
        found = np.roots([p[f"a{i}"] + sign * p[f"b{i}"] for i in (1, 2, 3)])
        assert sorted(found) == pytest.approx(poles, rel=0.01)


@pytest.mark.parametrize("name", ROWS)
def test_ranges_are_enforced(name):
    row = ROWS[name]
    assert parameters.checked(name, row.low) == row.low
    assert parameters.checked(name, row.high) == row.high
    below, above = math.nextafter(row.low, -math.inf), math.nextafter(row.high, math.inf)
    for value in (below, above, math.nan, math.inf, -math.inf):
        with pytest.raises(ValueError) as refusal:
            parameters.checked(name, value)
        expected = str(refusal.value)
        what = "a whole number" if row.whole else "a number"
        assert expected.startswith(f"parameter '{name}' is {value!r}; expected {what} in [") and "\n" not in expected


@pytest.mark.parametrize("value", ["much", None, [1.0, 2.0], {}])
def test_what_is_no_number_is_refused(value):
    with pytest.raises(ValueError, match=r"parameter 'friction' is .*; expected a number in \[0, 5\] m/s\^2"):
        Tables("match-v0", 1, parameters={"friction": value})


def test_unknown_names_come_with_a_suggestion():
    with pytest.raises(ValueError, match=r"^unknown parameter 'frictoin'; did you mean 'friction'\?$"):
        Tables("match-v0", 1, parameters={"frictoin": 0.1})
    with pytest.raises(ValueError, match=r"^unknown parameter 'zzz'; known: length, width, .*, impulse_speed$"):
        parameters.make_records(1, {"zzz": 0.1})


@pytest.mark.parametrize(
    "values, expected",
    [
        ({"width": 0.5, "goal_width": 0.45}, "goal_width leaves no wall beside the mouth"),
        ({"goal_width": 0.1, "puck_radius": 0.045, "width": 0.5}, None),
        ({"goal_width": 0.1, "puck_radius": 0.045}, None),
        ({"mallet_radius": 0.1, "width": 0.59}, "the table is too small"),
        ({"mallet_radius": 0.1, "length": 1.19}, "the table is too small"),
        ({"a1": 1e-3}, "gantry axis x is not overdamped"),
        ({"b2": -0.0057}, "gantry axis y is not overdamped"),
        ({"b2": 0.0058}, "gantry axis x is not overdamped"),
        ({"b3": 0.06}, "gantry axis x is not overdamped"),
        ({"a3": 0.01, "pulley_radius": 0.2}, "gantry axis x cannot be simulated: its top speed is 480 m/s"),
        ({"a3": 0.01, "pulley_radius": 0.02}, None),  # 48 m/s
        (
            {"a1": 1.9165e-6, "a2": 0.003139, "a3": 0.1, "pulley_radius": 0.2},
            "gantry axis y .* its acceleration is 1.*e",
        ),
        ({"a2": 1.0, "a3": 3e-3, "pulley_radius": 0.005}, "gantry axis x .* its slow mode is 1.34e"),
        ({"a1": 3e-4, "a2": 0.02}, "gantry axis x .* its fast mode is .* expected at most 0.005"),
    ],
)
def test_impossible_combinations(values, expected):
    """Each number alone is in its range; together they make no table, or, without a message here, just one."""
    if expected is None:
        parameters.make_records(1, values)
        return
    with pytest.raises(ValueError, match=f"^{expected}") as refusal:
        parameters.make_records(3, values)
    assert "\n" not in str(refusal.value)


@pytest.mark.slow
@pytest.mark.parametrize(
    "effects, expected",
    [
        ({"unlisted_force": {"kind": 1.0, "c00": 4.0, "c07": -2.0}}, "unlisted_force .* force is up to 6 m/s^2"),
        ({"unlisted_force": {"kind": 1.0, "c00": 4.0, "c24": 4.0}}, None),  # along x and along y
        ({"unlisted_force": {"kind": 9.0, "c08": 5.5}}, "unlisted_force .* force is up to 5.5 m/s^2"),
        ({"unlisted_force": {"kind": 8.0, "c00": 2.0, "c01": 1.0}}, "unlisted_force .* knot 1 is 1 after 2"),
        ({"unlisted_force": {"kind": 11.0, "c02": 0.1}}, "unlisted_force .* time from first to last knot is 0 s"),
        ({"unlisted_force": {"kind": 11.0, "c01": 1e4, "c02": 0.1}}, None),
        ({"unlisted_force": {"kind": 12.0, "c01": 0.1}}, "unlisted_force .* period is 0 s"),
        ({"unlisted_bounce": {"kind": 6.0, "c01": 0.1}}, "unlisted_bounce .* a length is 0 m"),
        ({"unlisted_bounce": {"kind": 7.0, "c00": 4.0, "c02": 1.0}}, "unlisted_bounce .* wall 4 is none"),
        ({"unlisted_bounce": {"kind": 7.0, "c01": 1.0, "c02": 1.0}}, "unlisted_bounce .* goes from 1 to 1 m"),
        ({"unlisted_window": {"kind": 1.0, "from": 2.0, "until": 1.0}}, "unlisted_window .* lasts from 2 until 1"),
        ({"unlisted_bounce": {"kind": 5.0, "c00": 2.0, "c01": -1.0}}, "unlisted_bounce .* a length is -1 m"),
        ({"unlisted_bounce": {"kind": 3.0, "c04": -1.0}}, "unlisted_bounce .* knot 4 is -1 after 0"),
        ({"unlisted_blow": {"kind": 1.0, "c02": 1.0}}, "unlisted_blow .* knot 3 is 0 after 1"),
        ({"unlisted_blow": {"kind": 1.0, "c07": 1.0}}, None),
        ({"unlisted_force": {"c00": 9.0}, "unlisted_bounce": {"c00": 9.0}, "unlisted_blow": {"c00": 9.0}}, None),
    ],
)
def test_tables_of_numbers_that_make_no_law(effects, expected):
    """Waves without a length, knots that fall, and forces that no puck on a table meets."""
    if expected is None:
        Tables("match-v0", 1, effects=effects)
        return
    with pytest.raises(ValueError, match=expected.replace("^", r"\^")):
        Tables("match-v0", 1, effects=effects)


def test_by_name_and_never_by_position():
    records = parameters.make_records(4, {"drag": 0.5, "friction": 0.25})
    matrix = parameters.as_matrix(records)
    assert matrix.shape == (4, len(parameters.TABLE))
    for row in parameters.TABLE:
        matrix[2, parameters.COLUMN[row.name]] = row.high
        assert records[2][row.name] == row.high, row.name
    assert records["drag"].tolist() == [0.5, 0.5, parameters.BY_NAME["drag"].high, 0.5]
    assert (records["friction"][[0, 1, 3]] == 0.25).all()


@pytest.mark.parametrize("name", [name for name, row in ROWS.items() if row.whole])
def test_what_a_law_is_a_function_of_is_a_whole_number(name):
    with pytest.raises(ValueError, match=rf"^parameter '{name}' is 1.5; expected a whole number in \[\d, \d+\]$"):
        parameters.checked(name, 1.5)
