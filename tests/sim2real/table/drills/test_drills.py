"""Fault drills at the twin: each fault is noticed by its cause, the mallet stops in time, and play goes on."""

from __future__ import annotations

import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

from sim2real.table.drills.drill import Drill
from sim2real.table.drills.faults import FAULTS, Fault
from sim2real.table.drills.picture_faults import PICTURE_FAULTS
from sim2real.table.game.robot_seat import make_robot_seat


@pytest.mark.slow
@pytest.mark.parametrize(
    ("fault", "camera"),
    [*((fault, "places") for fault in FAULTS), *((fault, "pictures") for fault in PICTURE_FAULTS)],
    ids=lambda one: getattr(one, "name", ""),
)
def test_a_fault_stops_the_mallet_and_play_goes_on_after_clear(fault: Fault, camera: str) -> None:
    env = make_robot_seat("puckpilot/match-v0", "twin", opponent="interceptor", camera=camera)
    try:
        drill = Drill(env, "interceptor", seed=5)
        drill.play(1.0)
        stop = drill.let_happen(fault, within=0.03)
        assert stop.cause in fault.causes
        assert stop.in_time
        drill.play(1.0)
        assert drill.monitor.worst.volts <= 15.0 and drill.monitor.worst.outside <= 0.0
    finally:
        env.close()
