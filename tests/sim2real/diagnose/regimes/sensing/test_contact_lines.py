"""The contact lines of the walls: found in bounces off them, and not in those off goal posts beside them."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.contact_lines import contact_lines
from sim2real.segmentation.causes import Geometry
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.velocity_jumps import VelocityJump

TABLE = Geometry(2.0, 1.0, 0.32, 0.03, 0.05)
STD = 0.0003


def bounces(along: np.ndarray, across: np.ndarray) -> list[VelocityJump]:
    """Bounces off the end wall x0 at `along` (n,) [m] from its middle, `across` (n,) [m] from it."""
    v_in, v_out = np.array([-2.0, 0.3]), np.array([1.6, 0.3])
    states = [np.array([k, x, 0.5 + y, *v_in, *v_out]) for k, (y, x) in enumerate(zip(along, across, strict=True))]
    return [
        VelocityJump(
            ContactEvent("wall", "x0", s[0], s[1], s[2], v_in, v_out, 0.01, (0, 1), 9.0, True), s, STD**2 * np.eye(7), k
        )
        for k, s in enumerate(states)
    ]


def test_a_slanted_wall_is_found() -> None:
    along = np.array([-0.45, -0.4, -0.3, -0.2, 0.2, 0.3, 0.4, 0.45])
    line = contact_lines(bounces(along, 0.03 + 0.01 * along), TABLE)["x0"]
    assert line.values == pytest.approx([0.03, 0.01], abs=1e-9)


def test_posts_make_no_wall() -> None:
    """A puck whose centre is between the posts touches one of them with its side, deeper than the wall's line."""
    along = np.array([0.155, 0.15, 0.145, 0.14, -0.155, -0.15])
    depth = np.sqrt(0.03**2 - (0.16 - np.abs(along)) ** 2)
    assert contact_lines(bounces(along, depth), TABLE) == {}
    beside_walls = np.array([-0.45, -0.4, -0.3, 0.3, 0.4, 0.45])
    both = bounces(np.append(beside_walls, along), np.append(np.full(6, 0.03), depth))
    line = contact_lines(both, TABLE)["x0"]
    assert sorted(line.along) == pytest.approx(beside_walls)
    assert line.values == pytest.approx([0.03, 0.0], abs=1e-9)
