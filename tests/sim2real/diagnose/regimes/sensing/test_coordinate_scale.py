"""When the contact lines of the walls show that the table has another size than stated."""

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.coordinate_scale import wrong_size
from sim2real.segmentation.causes import Geometry

STATED = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
ASSUMED = Geometry(2.0, 1.0, 0.32, 0.03, 0.05, frozenset({"length"}))


@pytest.mark.parametrize(
    "table, stretch, error, reason",
    [
        (STATED, 0.03, 0.0005, "stated length of 2.000 m differs by 3.0% from the observed 2.060 m"),
        (STATED, 0.04, 0.006, "stated length"),
        (STATED, 0.012, 0.0005, ""),
        (STATED, -0.29, 0.025, ""),  # one wall alone, whose contacts are a few millimetres off, determines nothing
        (ASSUMED, 0.012, 0.0005, "assumed length of 2.000 m differs by 1.2% from the observed 2.024 m"),
        (ASSUMED, 0.0012, 0.0005, ""),
    ],
)
def test_a_wrong_size_differs_from_a_stretched_map_and_from_too_few_contacts(table, stretch, error, reason):
    message = wrong_size(np.array([stretch, 0.0, 0.0]), np.array([error, 0.0005, 0.0005]), table)
    assert message.startswith("the " + reason) if reason else message == ""


@pytest.mark.parametrize(
    "values, wrong",
    [
        ((0.03, 0.0, 0.0), True),  # one size
        ((0.03, 0.03, 0.0), True),  # a tape that is too short
        ((0.03, 0.01, 0.0), False),
        ((0.03, 0.005, 0.005), True),  # a slight warp beside it
        ((0.03, 0.0, 0.01), False),  # sheared
        ((0.06, 0.0, 0.01), True),
    ],
)
def test_a_warped_map_is_no_wrong_size(values, wrong):
    assert bool(wrong_size(np.array(values), np.full(3, 0.0005), STATED)) is wrong
