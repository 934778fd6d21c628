"""The mallet's exact place by its encoders, against the report's equations done by hand."""

from __future__ import annotations

import math

import pytest

from sim2real.link.two_points import solve
from sim2real.table.physical.homing import exact_place

R, TURN = 0.0353, 16384


def raw(x: float, y: float, offsets: tuple[float, float]) -> tuple[int, int]:
    """What both encoders read within a turn at a place: (x - y)/R and (-x - y)/R less the offsets (report L.2)."""
    angles = (x - y) / R - offsets[0], (-x - y) / R - offsets[1]
    return tuple(round(angle / (2 * math.pi) * TURN) % TURN for angle in angles)  # pyright: ignore[reportReturnType]


@pytest.mark.parametrize("offsets", [(0.0, 0.0), (0.51, -1.22), (3.0, 3.1)])
@pytest.mark.parametrize("off", [(0.0, 0.0), (0.02, -0.01), (-0.015, 0.015)])
def test_a_place_put_roughly_by_hand_is_found_within_an_encoder_step(
    offsets: tuple[float, float], off: tuple[float, float]
) -> None:
    x, y = 0.2953, 0.572
    found = exact_place(raw(x, y, offsets), offsets, R, (x + off[0], y + off[1]))
    assert found == pytest.approx((x, y), abs=2 * math.pi / TURN * R)


def test_a_place_that_could_be_the_next_turn_is_refused() -> None:
    with pytest.raises(ValueError, match=r"put it within 33 mm of \(0.365, 0.572\) m"):
        exact_place(raw(0.2953, 0.572, (0.0, 0.0)), (0.0, 0.0), R, (0.365, 0.572))


def test_the_offsets_of_the_two_point_calibration_are_those_that_are_meant() -> None:
    corner, width, zero = (0.06, 0.05), 1.144, (1.0, -2.5)

    def read(x: float, y: float) -> tuple[float, float]:
        return (x - y) / R + zero[0], (-x - y) / R + zero[1]

    offsets = solve(read(*corner), read(corner[0], width - corner[1]), corner, width).offset
    assert offsets == pytest.approx((-zero[0], -zero[1]), abs=1e-9)
    assert exact_place(raw(0.3, 0.5, offsets), offsets, R, (0.31, 0.49)) == pytest.approx((0.3, 0.5), abs=2e-5)
