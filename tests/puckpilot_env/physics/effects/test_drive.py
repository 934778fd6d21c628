"""Motors that get less than a plan asks for: the mallet's path against the reference, and the rail that stops it."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.physics.gantry.drive import weaken
from puckpilot_env.physics.gantry.mallet import motion_at, next_switch
from sim2real.study.independent_table import Law, run
from tests.puckpilot_env.physics.table_driver import areas, new_table, plan_both, put_at_rest, record

WEAK = {"voltage_sag": 0.02, "motor_deadband": 0.4}
REFERENCE = Law(voltage_sag=0.02, deadband=0.4)
REQUESTS = np.array([(0.5, 0.7, 8.0, 6.0), (1.6, 0.3, 3.0, 12.0)])


def planned(requests: np.ndarray, places: np.ndarray, **values: float):
    """A table whose mallets begin a plan, and the plan as it was asked for: signed volts and times."""
    p = record(**values)
    table = new_table(p)
    for mallet, (x, y) in zip(table.mallets, places, strict=True):
        put_at_rest(mallet.x, x)
        put_at_rest(mallet.y, y)
    plan_both(table.mallets, requests, areas(p), p.max_voltage)
    both = (table.mallets[0], table.mallets[1])
    asked = [(m.x.volts, m.y.volts, m.x.t1, m.y.t1, m.x.t2, m.y.t2) for m in both]
    for mallet, area in zip(both, areas(p), strict=True):
        weaken(mallet, p, area, p.max_voltage)
    return both, asked


@pytest.mark.slow
def test_a_weak_supply_moves_a_mallet_as_in_the_reference() -> None:
    places = np.array([(0.2, 0.2), (1.3, 0.6)])
    mallets, asked = planned(REQUESTS, places, **WEAK)
    trace = run(REFERENCE, None, places, asked, 0.6, 2e-5)
    for mallet, path in zip(mallets, trace.mallets, strict=True):
        ours = np.array([motion_at(mallet, t) for t in trace.t])
        np.testing.assert_allclose(ours[:, :2], path[:, [0, 3]], atol=1e-7)
        np.testing.assert_allclose(ours[:, 2:], path[:, [1, 4]], atol=1e-5)
    assert np.abs(trace.mallets[0, -1, [0, 3]] - REQUESTS[0, :2]).max() > 0.01  # it does not come where it was sent


def test_full_volts_leave_a_plan_as_it_is() -> None:
    places = np.array([(0.2, 0.2), (1.3, 0.6)])
    mallets, _ = planned(REQUESTS, places)
    for mallet, request in zip(mallets, REQUESTS, strict=True):
        assert motion_at(mallet, 2.0)[:2] == pytest.approx(request[:2], abs=1e-9)


def test_the_rail_stops_a_mallet_that_brakes_too_weakly() -> None:
    """Both run to a far corner at full volts; then the supply fails to brake them, and they stop at the rail."""
    places, p = np.array([(0.2, 0.2), (1.3, 0.6)]), record()
    requests = np.array([(0.9, 0.94, 20.0, 20.0), (1.9, 0.06, 20.0, 20.0)])
    mallets, _ = planned(requests, places)
    stopped = 0
    for mallet, area in zip(mallets, areas(p), strict=True):
        for axis in (mallet.x, mallet.y):
            put_at_rest(axis, axis.rest)
            axis.volts *= 1.4  # more than was planned: it is too fast when it comes to brake
        weaken(mallet, p, area, p.max_voltage)
        path = np.array([motion_at(mallet, t) for t in np.linspace(0.0, 2.0, 4001)])
        switches = [next_switch(mallet, 0.0)]
        while np.isfinite(switches[-1]):
            switches.append(next_switch(mallet, switches[-1]))
        assert (path[:, 0] >= area[0]).all() and (path[:, 0] <= area[1]).all()
        assert (path[:, 1] >= area[2]).all() and (path[:, 1] <= area[3]).all()
        for axis, column in ((mallet.x, 2), (mallet.y, 3)):
            if np.isfinite(axis.halt):
                stopped += 1
                assert motion_at(mallet, axis.halt + 1e-9)[column] == 0.0
                assert axis.halt in switches
    assert stopped >= 2


@pytest.mark.parametrize(
    "values",
    [
        {"voltage_sag": 0.02},
        {"motor_deadband": 2.0},
        {"voltage_sag": 0.2, "motor_deadband": 6.0},
        {"command_delay": 0.09},
        {"motor_friction_left": 0.7, "motor_friction_right": 3.0, "axis_friction_x": 6.0, "axis_friction_y": 0.1},
        {"belt_hz": 8.0, "belt_zeta": 0.0},
        {"belt_hz": 60.0, "backlash_gap": 0.02, "axis_friction_y": 1.0, "voltage_sag": 0.2, "command_delay": 0.03},
    ],
    ids=str,
)
def test_no_mallet_leaves_its_half_in_a_game(values: dict[str, float]) -> None:
    tables = Tables("match-v0", 64, seed=3, parameters=values)
    rng, (low, high) = np.random.default_rng(1), tables.action_bounds
    bounds = areas(record())
    for _ in range(120):
        tables.step(np.clip(rng.uniform(low, high, (64, 2, 4)).astype(np.float32), low, high))
        for axis, first in (("x", 0), ("y", 2)):
            modes = tables.states["mallets"][axis]
            place = modes["rest"] + modes["slow"] + modes["fast"]
            assert (place >= bounds[:, first] - 1e-8).all() and (place <= bounds[:, first + 1] + 1e-8).all()
