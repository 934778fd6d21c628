"""Teams: each part is done once a run, sleepers are woken, nobody burns a core for long, nothing is left behind."""

from __future__ import annotations

import gc
import multiprocessing
import threading
import time

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.batch.team import Team, hand_in, take

PARTS = 12


class Job:
    """Counts who did which part; a part takes `pause` [s]."""

    def __init__(self, members: int, pause: float = 0.0) -> None:
        self.done = np.zeros((members, PARTS), int)
        self.pause = pause

    def serve(self, counters: np.ndarray, member: int, patience: int) -> None:
        """See `Team`; the interpreter's lock is free while looking for parts and while a part is done."""
        while (part := take(counters, PARTS, patience)) >= 0:
            time.sleep(self.pause)
            self.done[member, part] += 1
            hand_in(counters)


@pytest.mark.slow
@pytest.mark.parametrize("members", [2, 3, 7])
def test_each_part_is_done_once_a_run(members):
    job = Job(members)
    team = Team(members, PARTS, job.serve)
    for run in range(1, 1500):
        team.run()
        assert (job.done.sum(axis=0) == run).all()
        time.sleep(0.002 if run % 100 == 0 else 0.0)  # now and then long enough for workers to fall asleep
    team.close()


@pytest.mark.parametrize("rest", [0.0, 0.3])
def test_workers_take_part_awake_or_asleep(rest):
    job = Job(3, pause=0.02)
    team = Team(3, PARTS, job.serve)
    for _ in range(3):
        job.done[:] = 0
        time.sleep(rest)
        team.run()
        assert (job.done.sum(axis=1) > 0).all()
    team.close()


def test_a_team_at_rest_takes_no_processor_time():
    team = Team(3, PARTS, Job(3).serve)
    team.run()
    time.sleep(0.2)
    before = time.process_time()
    time.sleep(0.5)
    assert time.process_time() - before < 0.02
    team.close()


@pytest.mark.parametrize("with_a_part", [False, True])
def test_what_a_worker_raises_is_raised_by_run(with_a_part):
    job = Job(2, pause=0.02)

    def serve(counters, member, patience):
        if member == 1:
            if with_a_part:
                take(counters, PARTS, patience)
            raise MemoryError("no room")
        job.serve(counters, member, patience)

    team = Team(2, PARTS, serve)
    for _ in range(2):  # and nobody waits for ever for the part that was lost
        with pytest.raises(MemoryError, match="no room"):
            team.run()
    team.close()


def test_a_job_that_was_broken_off_does_not_spoil_the_next():
    job, ctrl_c = Job(2, pause=0.002), [True]

    def serve(counters, member, patience):
        if member == 0 and ctrl_c.pop():
            time.sleep(0.01)
            raise KeyboardInterrupt
        job.serve(counters, member, patience)

    team = Team(2, PARTS, serve)
    with pytest.raises(KeyboardInterrupt):
        team.run()
    begun = job.done.sum(axis=0)
    for run in range(1, 4):
        ctrl_c.append(False)
        team.run()
        assert (job.done.sum(axis=0) >= run).all()
    assert (job.done.sum(axis=0) <= 3 + np.maximum(begun, 1)).all()
    assert job.done.sum() <= 3 * PARTS + begun.sum() + 1  # at most the part that was under way
    team.close()


def test_close_ends_the_threads_and_the_leader_goes_on():
    before = threading.active_count()
    job = Job(4)
    team = Team(4, PARTS, job.serve)
    assert threading.active_count() == before + 3
    team.run()
    team.close()
    team.close()
    assert threading.active_count() == before
    team.run()
    assert (job.done.sum(axis=0) == 2).all()


def test_tables_that_are_forgotten_leave_no_threads():
    before = threading.active_count()
    tables = Tables("match-v0", 40, threads=3)
    assert threading.active_count() == before + 2
    del tables
    gc.collect()
    assert threading.active_count() == before


@pytest.mark.skipif("fork" not in multiprocessing.get_all_start_methods(), reason="this system cannot fork")
def test_a_forked_process_plays_on_by_itself():
    tables = Tables("match-v0", 200, seed=1, threads=3)
    low, high = tables.action_bounds
    script = np.random.default_rng(0).uniform(low, high, (5, 200, 2, 4)).astype(np.float32)
    tables.step(script[0])
    printed, child_end = multiprocessing.Pipe(duplex=False)

    def play() -> None:
        for actions in script[1:]:
            tables.step(actions)
        child_end.send(tables.observations)

    child = multiprocessing.get_context("fork").Process(target=play, daemon=True)
    child.start()
    for actions in script[1:]:
        tables.step(actions)
    assert printed.poll(60.0)
    assert printed.recv().tobytes() == tables.observations.tobytes()
    child.join()
    tables.close()
