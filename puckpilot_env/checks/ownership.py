"""That arrays which an environment hands out belong to the caller: nobody else changes or reads them afterwards."""

from __future__ import annotations

import copy
from collections import deque
from itertools import combinations

import numpy as np

from puckpilot_env.checks.compare import arrays, difference
from puckpilot_env.checks.result import Check, Fault, Subject
from puckpilot_env.checks.seeding import require_reproducible
from puckpilot_env.checks.walk import walk, walk_together

KEPT = 8  # moments that are kept and looked at again
STEPS = 300  # enough here: aliasing shows at once


def _kept(subject: Subject) -> str:
    held: deque = deque(maxlen=KEPT)
    for moment in walk(subject.make(), subject.steps, subject.seed):
        for then, copied in held:
            found = difference(copied, then.returned)
            if found is not None:
                raise Fault(f"what {then.name} returned changed by {moment.name}: {found}")
        held.append((moment, copy.deepcopy(moment.returned)))
    return f"what a step returned stays as it was for the next {KEPT}"


def _shared(subject: Subject) -> str:
    for moment in walk(subject.make(), min(STEPS, subject.steps), subject.seed):
        for a, b in combinations(moment.observations, 2):
            for (at, x), (_, y) in (
                (p, q) for p in arrays(moment.observations[a]) for q in arrays(moment.observations[b])
            ):
                if (x.flags.writeable or y.flags.writeable) and np.shares_memory(x, y):
                    raise Fault(
                        f"{moment.name}: observations{at} of {a} and {b} are the same memory, and can be written"
                    )
    return "no two agents' observations share memory"


def _scribble(returned: dict) -> None:
    for _, array in arrays(returned):
        if array.flags.writeable and array.dtype.kind in "fiub":
            array[...] = 1 - array if array.dtype.kind != "b" else ~array


def _written(subject: Subject) -> str:
    steps = min(STEPS, subject.steps)
    require_reproducible(subject, steps)
    for untouched, written in walk_together((subject.make(), subject.make()), steps, subject.seed):
        found = difference(untouched.returned, written.returned)
        if found is not None:
            raise Fault(f"writing into returned arrays changed the game by {written.name}: {found}")
        _scribble(written.returned)
    return f"{steps:,} steps go on the same when every returned array is written over"


CHECKS = (
    Check(
        "kept arrays stay",
        "A replay buffer may keep what it was given without a copy.",
        "Return copies of internal buffers.",
        _kept,
    ),
    Check(
        "agents share no memory",
        "Normalizing one agent's observation in place does not change another's.",
        "Give each agent an array of its own, or mark the common one read-only.",
        _shared,
    ),
    Check(
        "the caller may write",
        "Changing an observation in place does not change the game.",
        "Return copies of internal state, in infos too.",
        _written,
    ),
)
