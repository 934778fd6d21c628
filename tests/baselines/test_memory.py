"""Players compute in memory that is theirs: what anything else allocates meanwhile does not reach their actions."""

from __future__ import annotations

import ctypes
import os
import subprocess
import sys

import numpy as np
import pytest

from baselines import Seat, make_player
from puckpilot_env.tables import Tables
from tests.places import ROOT

PLAYERS = ("bank_shot", "veteran")
STEPS = 12


def _use_up_what_is_free() -> None:
    """Takes what the heap holds free, so that the next block to be freed is the first to be given out again."""
    malloc = ctypes.CDLL(None).malloc
    malloc.restype = ctypes.c_void_p
    for size in range(16, 4096, 16):
        for _ in range(40):
            malloc(size)


def _unlike(name: str) -> int:
    """In how many of some steps the player acts otherwise where the heap holds nothing free."""
    tables = Tables("attack-v0", 40, seed=5)
    player, twin = (make_player(name, Seat.from_tables(tables, seed=2)) for _ in range(2))
    middle, unlike = np.tile(tables.action_bounds.mean(axis=0), (len(tables), 1)), 0
    for _ in range(STEPS):
        expected = twin.act(tables.observations[:, 1])
        _use_up_what_is_free()
        unlike += not np.array_equal(player.act(tables.observations[:, 1]), expected)
        tables.step(np.stack([middle, expected], axis=1))
    return unlike


@pytest.mark.parametrize("name", PLAYERS)
def test_no_player_reads_what_was_freed(name: str) -> None:
    """In a process of its own, whose heap keeps nothing back for each thread."""
    code = f"from tests.baselines.test_memory import _unlike; print(_unlike('{name}'))"
    environment = {**os.environ, "GLIBC_TUNABLES": "glibc.malloc.tcache_count=0", "MALLOC_PERTURB_": "85"}
    done = subprocess.run([sys.executable, "-c", code], env=environment, cwd=ROOT, text=True, capture_output=True)
    assert done.stdout == "0\n", done.stderr
