"""Threads that share the parts of a job, and look out for the next job for a while before they sleep.

Waking a sleeping thread, or passing on the interpreter's lock, takes as long as stepping a hundred tables. So a worker
stays in one kernel from job to job, and takes parts by counting up a number that all threads see. The job is always the
same, on the same arrays; what changes is what stands in them.
"""

from __future__ import annotations

import time
import weakref
from collections.abc import Callable
from queue import SimpleQueue
from threading import Thread, current_thread
from typing import Any

import numpy as np
from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import intrinsic
from numba.np import arrayobj
from numpy.typing import NDArray

from puckpilot_env.kernel import kernel

Serve = Callable[[NDArray[np.int64], int, int], object]
PATIENCE = 200_000  # looks for a part before a worker sleeps: 0.14 ms
NAP = 5e-5  # s, of the leader where another's last part is long in coming
_TAKEN, _DONE, _ASLEEP, _COUNTERS = 0, 16, 32, 48  # the counters' places, far enough apart to share no cache line
_intrinsic: Any = intrinsic  # numba itself gives what it makes its first argument, `context`


def _pointer(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    counters = arrayobj.make_array(signature.args[0])(context, builder, arguments[0])
    return cgutils.get_item_pointer(context, builder, signature.args[0], counters, [arguments[1]], wraparound=False)


@_intrinsic
def _load(context, counters, place):
    """A counter as it is now, whoever wrote it."""

    def generate(context, builder, signature, arguments):
        pointer = _pointer(context, builder, signature, arguments)
        return builder.load_atomic(pointer, "seq_cst", 8, typ=ir.IntType(64))

    return types.int64(counters, types.intp), generate


@_intrinsic
def _add(context, counters, place, number):
    """Add to a counter, at one go; what it was before."""

    def generate(context, builder, signature, arguments):
        return builder.atomic_rmw("add", _pointer(context, builder, signature, arguments), arguments[2], "seq_cst")

    return types.int64(counters, types.intp, types.int64), generate


@_intrinsic
def _exchange(context, counters, place, number):
    """Set a counter, at one go; what it was before."""

    def generate(context, builder, signature, arguments):
        return builder.atomic_rmw("xchg", _pointer(context, builder, signature, arguments), arguments[2], "seq_cst")

    return types.int64(counters, types.intp, types.int64), generate


@kernel
def take(counters, parts, patience):
    """Number of the next of the job's `parts`, which is now the caller's; -1 if `patience` further looks found none."""
    for _ in range(patience + 1):
        if _load(counters, _TAKEN) < parts:
            part = _add(counters, _TAKEN, 1)
            if part < parts:
                return part
    return -1


@kernel
def hand_in(counters):
    """A part that was taken is done."""
    _add(counters, _DONE, 1)


@kernel
def _begin(counters, parts):
    """Offer all parts; how many workers are asleep, who do not see it. What is left of a job that was broken off (by
    ctrl-C) is forgotten, but not while someone is at it."""
    taken = min(_exchange(counters, _TAKEN, parts), parts)
    while _load(counters, _DONE) < taken:
        pass
    _exchange(counters, _DONE, 0)
    _exchange(counters, _TAKEN, 0)
    return _exchange(counters, _ASLEEP, 0)


@kernel
def _all_done(counters, parts, patience):
    looks = 0
    while _load(counters, _DONE) < parts and looks < patience:
        looks += 1
    return _load(counters, _DONE) == parts


@kernel
def _announce_sleep(counters):
    _add(counters, _ASLEEP, 1)


def _work(member: int, serve: Serve, counters: NDArray[np.int64], calls: Any, failures: list[Any]) -> None:
    """What a worker does. It knows no `Team`, so that one that is forgotten can be given up."""
    try:
        while calls.get():
            serve(counters, member, PATIENCE)
            _announce_sleep(counters)  # from now on it is called for a job; one that began before, it sees itself
            serve(counters, member, 0)
    except BaseException as error:  # it is raised where the job was given
        failures.append(error)


def _end(calls: Any, workers: list[Thread]) -> None:
    for _ in workers:
        calls.put(False)
    for worker in workers:
        if worker is not current_thread():  # which gives up the team, where the garbage collector ran in it
            worker.join()


class Team:
    """A thread that leads and its workers, who do the parts of the job together each time that it calls `run`."""

    def __init__(self, members: int, parts: int, serve: Serve) -> None:
        """Start `members - 1` workers for a job of so many parts.

        `serve(counters, member, patience)` does what `take(counters, parts, patience)` gives it until that is -1, and
        calls `hand_in(counters)` after each part, all in one kernel. `member` is from 0, the leader, to `members - 1`.
        """
        self._parts, self._serve = parts, serve
        self._counters = np.zeros(_COUNTERS, np.int64)
        self._counters[[_TAKEN, _DONE, _ASLEEP]] = parts, parts, members - 1
        self._calls: SimpleQueue[bool] = SimpleQueue()  # to whoever sleeps: True for work, False for the end
        self._failures: list[BaseException] = []
        shared = (serve, self._counters, self._calls, self._failures)
        workers = [Thread(target=_work, args=(member, *shared), daemon=True) for member in range(1, members)]
        for worker in workers:
            worker.start()
        self._end = weakref.finalize(self, _end, self._calls, workers)

    def run(self) -> None:
        """Do the job once, with whoever has time for it. Raises what was raised in a worker."""
        if not self._failures:
            for _ in range(_begin(self._counters, self._parts)):
                self._calls.put(True)
            self._serve(self._counters, 0, 0)
        while not self._failures and not _all_done(self._counters, self._parts, PATIENCE):
            time.sleep(NAP)
        if self._failures:
            raise self._failures[0]

    def close(self) -> None:
        """End the workers; the leader can still do the job by itself."""
        self._end()
