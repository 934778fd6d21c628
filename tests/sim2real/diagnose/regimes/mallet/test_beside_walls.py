"""Contacts beside a wall that the puck meets before the next frame: what follows is not the mallet's work alone."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.regimes.mallet.data import _comes_from_a_wall
from sim2real.segmentation.causes import Geometry

TABLE = Geometry(2.0, 1.0, 0.3, 0.031, 0.05)


@pytest.mark.parametrize(
    ("place", "velocity", "expected"),
    [
        ((0.759, 0.951), (2.79, -1.30), True),  # 18 mm from a wall that it met 10 ms later, at 1.9 m/s
        ((0.759, 0.951), (2.79, 1.30), False),  # it has not met it yet
        ((0.759, 0.851), (2.79, -1.30), False),  # too far from it
        ((0.050, 0.500), (3.00, 0.00), True),
        ((1.950, 0.500), (3.00, 0.00), False),
        ((0.759, 0.049), (0.00, 0.50), False),  # so slow that it would have been seen on its way to the wall
    ],
)
def test_a_puck_that_may_have_met_a_wall_since_is_told(
    place: tuple[float, float], velocity: tuple[float, float], expected: bool
) -> None:
    assert _comes_from_a_wall(np.array(place), np.array(velocity), TABLE) == expected
