"""Words for mechanisms, numbers and counts."""

import pytest

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.report.plain_words import FAULTS, chance, clause, counted, digits_of, explained, unit_words
from sim2real.diagnose.result.result import Estimate


@pytest.mark.parametrize("mechanism", [*(name for name, effect in EFFECTS.items() if effect.listed), *FAULTS])
def test_every_mechanism_has_a_clause_that_fits_a_headline(mechanism):
    assert 2 <= len(clause(mechanism).split()) <= 14
    assert clause(mechanism)[0].islower() and clause(mechanism) in explained(mechanism).lower()


def test_a_mechanism_without_a_description_has_none():
    assert clause("unlisted") == explained("unlisted") == ""


@pytest.mark.parametrize(
    "value, half, expected",
    [
        (0.05315012, 1.5e-6, ("0.0531501", "0.0531486", "0.0531516")),
        (0.02, 0.001, ("0.02", "0.019", "0.021")),
        (0.0, 0.0, ("0", "0", "0")),
        (3.0, 0.0, ("3", "3", "3")),
    ],
)
def test_digits_distinguish_a_value_from_its_bounds(value, half, expected):
    assert digits_of(Estimate(value, value - half, value + half, "1")) == expected


def test_units_and_counts():
    assert [unit_words(unit) for unit in ("V s^3", "m/s^2", "1", "1/s")] == ["V s³", "m/s²", "", "1/s"]
    assert (counted(1, "launch", "launches"), counted(2, "launch", "launches")) == ("1 launch", "2 launches")
    assert (chance(1e-300), chance(2.04e-9)) == ("p < 1e-300", "p = 2.0e-09")
