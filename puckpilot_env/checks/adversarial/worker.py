"""Batches of `adversarial` one after another in a process of their own, which is ended where a step does not end."""

from __future__ import annotations

import time
from collections.abc import Callable, Sequence
from multiprocessing import get_context
from typing import Any

from puckpilot_env.checks.adversarial import extremes
from puckpilot_env.checks.adversarial.play import STEPS_OF_A_BATCH, TABLES, Breach, Found, Place, play_batch

PATIENCE = 20.0  # s, for a single step of a single table; one of them takes some microseconds
LOOK = 0.2  # s, between two looks at where a batch is
_NOWHERE = -1


def _work(tasks: Any, place: Any) -> None:
    """What the process does: the batches that it is given, noting where it is in them."""

    def note(step: int, table: int) -> None:
        place[0] = step * TABLES + table

    while (task := tasks.recv()) is not None:
        name, seed = task
        tasks.send(play_batch(name, seed, note))


class Worker:
    """The process, and where it is in a batch."""

    def __init__(self, patience: float = PATIENCE) -> None:
        self._context = get_context("spawn")
        self._patience = patience
        self._begin()

    def _begin(self) -> None:
        self._place: Any = self._context.RawArray("q", 1)
        self._tasks, others = self._context.Pipe()
        self._process = self._context.Process(target=_work, args=(others, self._place), daemon=True)
        self._process.start()
        others.close()

    def play(self, name: str, seed: int) -> Found:
        """What a batch brings; if a step of it does not end, that is what it brings."""
        self._place[0] = _NOWHERE
        self._tasks.send((name, seed))
        at, since = _NOWHERE, time.monotonic()
        while not self._tasks.poll(LOOK):
            if self._place[0] != at or at == _NOWHERE:  # before its first step it may have to compile
                at, since = self._place[0], time.monotonic()
            elif time.monotonic() - since > self._patience:
                self.end()
                self._begin()
                return _endless(name, seed, at, self._patience)
        return self._tasks.recv()

    def end(self) -> None:
        """End the process."""
        self._process.kill()
        self._process.join()
        self._tasks.close()


def _endless(name: str, seed: int, at: int, patience: float) -> Found:
    step, table = divmod(at, TABLES)
    tables, _ = extremes.draw_tables(name, TABLES, seed)
    place = Place(name, seed, table, step, extremes.described(tables, table))
    return Found(at, [Breach(f"a step does not end within {patience:g} s", place)])


def play_many(names: Sequence[str], steps: int, seed: int, show: Callable[[Found], None]) -> Found:
    """So many steps, rounded up to whole batches, of the ids in turn: batch k has the seed `seed + k`. `show` is given
    what each batch brought."""
    found, worker = Found(), Worker()
    try:
        for k in range(-(-steps // STEPS_OF_A_BATCH)):
            batch = worker.play(names[k % len(names)], seed + k)
            found.add(batch)
            show(batch)
    finally:
        worker.end()
    return found
