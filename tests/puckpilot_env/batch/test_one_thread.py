"""A second thread on the same tables is refused, and neither thread's steps are lost."""

from __future__ import annotations

import threading
from typing import Any

import gymnasium
import numpy as np
import pytest

from puckpilot_env import Tables, match_v0

TOLD = r"^{}\(\) by two threads at once on the same tables; expected one thread at a time: give each its own tables"


class Slow:
    """Actions that are ready when `go` is set; `begun` says that someone is waiting for them."""

    def __init__(self, actions: np.ndarray) -> None:
        self.actions, self.begun, self.go = actions, threading.Event(), threading.Event()

    def __array__(self, *_: Any, **__: Any) -> np.ndarray:
        self.begun.set()
        assert self.go.wait(10.0)
        return self.actions


def while_inside(step: Any, actions: np.ndarray, calls: dict[str, Any]) -> None:
    """Each of the calls is refused while another thread is in `step`."""
    slow = Slow(actions)
    other = threading.Thread(target=step, args=(slow,))
    other.start()
    assert slow.begun.wait(10.0)
    try:
        for name, call in calls.items():
            with pytest.raises(RuntimeError, match=TOLD.format(name)):
                call()
    finally:
        slow.go.set()
        other.join()


@pytest.mark.parametrize("threads", [1, 2])
def test_a_second_thread_is_refused_and_no_step_is_lost(threads: int) -> None:
    tables, alone = (Tables("match-v0", 40, seed=1, threads=threads) for _ in range(2))
    actions = np.full((40, 2, 4), 0.4, np.float32)
    saved = tables.snapshot()
    calls = {
        "step": lambda: tables.step(actions),
        "reset": lambda: tables.reset(5),
        "snapshot": tables.snapshot,
        "restore": lambda: tables.restore(saved),
        "turn": tables.turn,
    }
    for _ in range(3):
        while_inside(tables.step, actions, calls)
        alone.step(actions)
    tables.step(actions)  # and after that it is free again
    alone.step(actions)
    assert tables.states.tobytes() == alone.states.tobytes()
    tables.close()
    alone.close()


def test_after_an_error_the_next_thread_may_come_in() -> None:
    tables = Tables("match-v0", 1)
    with pytest.raises(ValueError, match="actions have shape"):
        tables.step(np.zeros(3))
    other = threading.Thread(target=tables.reset, args=(1,))
    other.start()
    other.join()
    assert tables.states["steps"][0] == 0


def test_environments_refuse_a_second_thread_too() -> None:
    action = np.full(4, 0.4, np.float32)
    env: Any = match_v0.parallel_env()
    env.reset(seed=1)
    both = {"player_0": action, "player_1": action}
    calls = {"step": lambda: env.step(both), "reset": env.reset}
    while_inside(lambda slow: env.step({**both, "player_0": slow}), action, calls)
    assert env.tables.states["steps"][0] == 1
    seat: Any = gymnasium.make("puckpilot/match-v0", disable_env_checker=True)
    seat.reset(seed=1)
    while_inside(seat.step, action, {"reset": seat.unwrapped.reset, "step": lambda: seat.unwrapped.step(action)})
    assert seat.unwrapped.tables.states["steps"][0] == 1
