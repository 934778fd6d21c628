"""Deadlines, by a clock of the test's own."""

from __future__ import annotations

import asyncio

import pytest

from sim2real.arena import ticking
from sim2real.arena.ticking import Lateness, Ticking


def played(
    monkeypatch: pytest.MonkeyPatch, costs: list[float], rate: float = 100.0, lateness: Lateness | None = None
) -> list[float]:
    """When each step came [s], if the n-th takes `costs[n]` [s] and nothing else any time."""
    clock, came = [0.0], []

    class Loop:
        def time(self) -> float:
            return clock[0]

    async def sleep(seconds: float) -> None:
        clock[0] += seconds

    def step() -> None:
        came.append(clock[0])
        clock[0] += costs[len(came) - 1]
        if len(came) == len(costs):
            raise asyncio.CancelledError

    monkeypatch.setattr(ticking.asyncio, "get_running_loop", Loop)
    monkeypatch.setattr(ticking.asyncio, "sleep", sleep)
    ticks = Ticking(step, rate, lateness)
    with pytest.raises(asyncio.CancelledError):
        ticks.run().send(None)
    return came


def test_a_slow_step_is_made_up_for(monkeypatch: pytest.MonkeyPatch) -> None:
    came = played(monkeypatch, [0.001, 0.025, 0.001, 0.001, 0.001, 0.0])
    assert came == pytest.approx([0.0, 0.01, 0.035, 0.036, 0.04, 0.05])


def test_a_machine_that_slept_does_not_race(monkeypatch: pytest.MonkeyPatch) -> None:
    came = played(monkeypatch, [10.0, 0.001, 0.001, 0.0])
    assert came == pytest.approx([0.0, 10.0, 10.01, 10.02])


def test_it_is_counted_how_late_steps_were(monkeypatch: pytest.MonkeyPatch) -> None:
    lateness = Lateness()
    played(monkeypatch, [0.001, 0.025, 0.001, 10.0, 0.001, 0.0], lateness=lateness)
    assert lateness.steps == 6 and lateness.late == 2  # by 15 and 9996 ms; the one between by 6
    assert lateness.latest == pytest.approx(9.996) == lateness.lost
