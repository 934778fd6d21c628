"""When the lines of the walls say that the table has another size than stated."""

import numpy as np
import pytest

from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.sensing.scale import wrong_size

STATED = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
GUESSED = Geometry(2.0, 1.0, 0.32, 0.03, 0.05, frozenset({"length"}))


@pytest.mark.parametrize(
    "table, stretch, error, told",
    [
        (STATED, 0.03, 0.0005, "stated length of 2.000 m is 3.0% off the 2.060 m"),
        (STATED, 0.04, 0.006, "stated length"),
        (STATED, 0.012, 0.0005, ""),
        (STATED, -0.29, 0.025, ""),  # one wall alone, whose touches are a few millimetres off, tells nothing
        (GUESSED, 0.012, 0.0005, "guessed length of 2.000 m is 1.2% off the 2.024 m"),
        (GUESSED, 0.0012, 0.0005, ""),
    ],
)
def test_a_wrong_size_is_told_from_a_stretched_map_and_from_too_few_touches(table, stretch, error, told):
    said = wrong_size(np.array([stretch, 0.0, 0.0]), np.array([error, 0.0005, 0.0005]), table)
    assert said.startswith("the " + told) if told else said == ""


@pytest.mark.parametrize(
    "values, wrong",
    [
        ((0.03, 0.0, 0.0), True),  # one size
        ((0.03, 0.03, 0.0), True),  # a tape that is too short
        ((0.03, 0.01, 0.0), False),
        ((0.03, 0.005, 0.005), True),  # a slight bend beside it
        ((0.03, 0.0, 0.01), False),  # sheared
        ((0.06, 0.0, 0.01), True),
    ],
)
def test_a_map_that_is_bent_is_no_wrong_size(values, wrong):
    assert bool(wrong_size(np.array(values), np.full(3, 0.0005), STATED)) is wrong
