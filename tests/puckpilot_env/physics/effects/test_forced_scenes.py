"""Hard scenes under forces at the ends of their ranges: nothing inside anything, and energy never from nowhere."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.physics.contacts import bounce
from tests.puckpilot_env.physics import sweeps
from tests.puckpilot_env.physics.table_driver import (
    PVX,
    PVY,
    PX,
    PY,
    SAMPLE_COLUMNS,
    areas,
    new_log,
    new_table,
    plan_both,
    play,
    put_at_rest,
    record,
)
from tests.puckpilot_env.physics.test_containment import DEEPEST_IN_MALLET, DEEPEST_OUTSIDE

pytestmark = pytest.mark.slow

FORCED = {
    "tilt": {"tilt_x": 0.2, "tilt_y": -0.2},
    "tilt, elastic": {"tilt_x": -0.2, "tilt_y": 0.2, "wall_restitution": 1.0, "mallet_restitution": 1.0},
    "tilt, dead walls": {"tilt_x": -0.2, "tilt_y": 0.2, "wall_restitution": 0.0, "mallet_restitution": 0.0},
    "bowl": {"warp_xx": 1.0, "warp_yy": 1.0, "warp_xy": -1.0},
    "hill without friction": {"warp_xx": -1.0, "warp_yy": -1.0, "friction": 0.0, "drag": 0.0},
    "sideways": {"side_force": 2.0},
    "grain": {"friction_anisotropy": 1.0, "friction_turning": 1.0, "tilt_x": 0.2},
    "ice in the middle": {"patch_x": 1.0, "patch_y": 0.5, "patch_radius": 0.5, "patch_extra": -5.0, "warp_yy": -1.0},
    "sand in the middle": {"patch_x": 1.0, "patch_y": 0.5, "patch_radius": 0.5, "patch_extra": 5.0, "tilt_y": 0.2},
}


@pytest.mark.parametrize("name", FORCED)
def test_nothing_is_inside_anything(name, effort):
    units = sweeps.random_units(5, 1000 * effort)
    verdicts = sweeps.judge(record(**FORCED[name]), units, 0.1, 50)
    found = verdicts[~np.isnan(verdicts[:, 0])]
    assert len(found) > 0.4 * len(units)
    for column, bar in (
        (sweeps.OUTSIDE, DEEPEST_OUTSIDE),
        (sweeps.INTO_POST, DEEPEST_OUTSIDE),
        (sweeps.INTO_MALLET, DEEPEST_IN_MALLET),
    ):
        assert found[:, column].max() <= bar, column
    assert found[:, sweeps.GAIN].max() <= 1e-12
    if "elastic" not in name:  # there a squeezed puck bounces up to `advance.MANY_EVENTS` times
        assert found[:, sweeps.EVENTS].max() < 1000


def height(values: dict[str, float], x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Potential energy per unit mass of a tilt and a warp [J/kg], by hand."""
    tilt_x, tilt_y, xx, yy, xy = (values.get(n, 0.0) for n in ("tilt_x", "tilt_y", "warp_xx", "warp_yy", "warp_xy"))
    dx, dy = x - 1.0, y - 0.5
    return 0.5 * (xx * dx**2 + yy * dy**2) + xy * dx * dy - tilt_x * dx - tilt_y * dy


@pytest.mark.parametrize("name", ["tilt", "tilt, elastic", "tilt, dead walls", "bowl", "hill without friction"])
def test_energy_never_comes_from_nowhere(name):
    """Ten seconds of pucks among mallets at rest: kinetic and potential energy together only fall."""
    values = FORCED[name]
    p, rng = record(**values), np.random.default_rng(6)
    for _ in range(10):
        table = new_table(p)
        places = np.array([(0.3, 0.5), (1.6, 0.4)])
        for k in range(2):
            put_at_rest(table.mallets[k].x, places[k, 0])
            put_at_rest(table.mallets[k].y, places[k, 1])
        plan_both(table.mallets, np.hstack([places, np.ones((2, 2))]), areas(p), p.max_voltage)
        table.puck.x, table.puck.y = rng.uniform(0.5, 1.4), rng.uniform(0.1, 0.9)
        table.puck.vx, table.puck.vy = rng.normal(0.0, 0.7, 2)
        out = np.zeros((1001, SAMPLE_COLUMNS))
        kind, rows, _ = play(table.puck, p, table.mallets, 0.0, 10.0, out, new_log())
        if kind != bounce.NOTHING:
            rows -= 1  # a goal takes the speed
        energy = 0.5 * (out[:rows, PVX] ** 2 + out[:rows, PVY] ** 2) + height(values, out[:rows, PX], out[:rows, PY])
        assert np.isfinite(energy).all()
        assert np.diff(energy).max(initial=0.0) < 1e-7
