"""Curves of glide laws over one coordinate: the other coordinates are fixed, and the curve equals the law."""

import numpy as np
import pytest

from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.trajectory import accelerations
from sim2real.diagnose.regimes.sliding.views import listed_view, varied

SIZE = np.array([2.0, 1.0])
X = np.linspace(0.1, 0.9, 7)
PATCH = {"patch_x": 0.5, "patch_y": 0.3, "patch_radius": 0.35, "patch_extra": 0.2}
BASE = {"friction": 0.1, "drag": 0.2}
LAWS = {  # mechanism: its parameters, and what it adds along the view's direction at the coordinate x, by hand
    "table_tilt": ({"tilt_x": 0.02, "tilt_y": -0.01}, lambda h: np.full_like(h, 0.02)),
    "linear_drag": ({"linear_drag": 0.05}, lambda v: -0.05 * v),
    "air_drift": ({"air_drift": 0.01}, lambda t: -0.1 * 0.01 * t),
    "side_force": ({"side_force": 0.03}, lambda v: 0.03 * v),
    "friction_anisotropy": ({"friction_anisotropy": 0.2}, lambda h: -0.1 * 0.2 * np.cos(2.0 * h)),
    "table_warp": ({"warp_xx": 0.1, "warp_yy": 0.02, "warp_xy": 0.3}, lambda x: -0.1 * (x - 1.0)),
    "friction_patch": (PATCH, lambda r: np.where(r < 0.35, -0.2, 0.0)),
}


@pytest.mark.parametrize("mechanism", LAWS)
def test_a_law_over_its_coordinate(mechanism):
    own, by_hand = LAWS[mechanism]
    values = {"warp_xx": 0.0, "warp_yy": 0.0, **BASE, **own}
    never = np.full(7, np.nan)
    usual = Motion(
        X, np.tile(SIZE / 3, (7, 1)), np.tile([0.3, 0.4], (7, 1)), never, never, never, SIZE, np.array([0.1, 2.0])
    )
    look, at = listed_view(mechanism, values), varied(mechanism, values, usual, X)
    assert look.coordinate(at) == pytest.approx(X)
    if mechanism not in ("linear_drag", "side_force"):
        assert np.linalg.norm(at.velocity, axis=1) == pytest.approx(np.full(7, 0.5))
    added = look.of(at, accelerations(values, at) - accelerations(BASE, at))
    assert added == pytest.approx(by_hand(np.radians(X) if look.label.startswith("heading") else X), abs=1e-6)
