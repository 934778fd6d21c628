"""A policy of somebody else plays in a process of its own, which is ended where it takes too long or too much memory.

The file is data and is read as such, so that there is no code to run; what it can still do is to be slow or large.
"""

from __future__ import annotations

import json
import os
import resource
import subprocess
import sys
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

from agents.benchmark.evaluation import Against, evaluate
from agents.benchmark.protocol import Protocol, Task
from agents.policy.policy import find_policy_player

PASSED_ON = ("PATH", "HOME", "XDG_CACHE_HOME", "NUMBA_CACHE_DIR", "PYTHONPATH", "LANG")  # of the environment
LARGEST_FILE = 1 << 28  # bytes that it may write: compiled code of the simulator
Request = dict[str, Any]


class SandboxError(Exception):
    """The process was ended, or failed; in one line why."""


@dataclass(frozen=True)
class Limits:
    """Of a process that plays one task: wall-clock time [s] and address space [bytes]."""

    seconds: float = 1200.0
    memory: int = 4 << 30


def play_in_sandbox(
    policy: Path, task: Task, protocol: Protocol, games: int, seed: int, limits: Limits
) -> list[Against]:
    """Play a policy's file, or that which is beside it for the task, against the protocol's opponents. SandboxError
    where that does not end well."""
    request = {
        "policy": str(policy.resolve()), "variant": task.variant,
        "opponents": protocol.evaluated_against(task), "games": games, "seed": seed,
    }  # fmt: skip
    environment = {name: os.environ[name] for name in PASSED_ON if name in os.environ}
    environment |= dict.fromkeys(("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS"), "1")
    words = [sys.executable, "-m", __name__, json.dumps(request)]
    try:
        done = subprocess.run(
            words, capture_output=True, text=True, timeout=limits.seconds, env=environment,
            preexec_fn=partial(_limit, limits), check=False,
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        raise SandboxError(f"did not end within {limits.seconds:g} s") from None
    except (OSError, subprocess.SubprocessError) as error:
        raise SandboxError(f"no process could be begun: {error}") from None
    if done.returncode:
        last = (done.stderr.strip().splitlines() or [f"ended with {done.returncode}"])[-1]
        raise SandboxError(last[:200])
    rows: list[dict[str, Any]] = json.loads(done.stdout)
    for row in rows:
        row["goals"] = tuple(row["goals"])
    return [Against(**row) for row in rows]


def _limit(limits: Limits) -> None:
    """Set the limits of this process, before it becomes the player's."""
    seconds = int(limits.seconds) + 1
    for kind, most in (
        (resource.RLIMIT_AS, limits.memory), (resource.RLIMIT_CPU, seconds), (resource.RLIMIT_FSIZE, LARGEST_FILE),
        (resource.RLIMIT_CORE, 0),
    ):  # fmt: skip
        _, hard = resource.getrlimit(kind)
        least = most if hard == resource.RLIM_INFINITY else min(most, hard)
        resource.setrlimit(kind, (least, least))


def _play(request: Request) -> list[dict[str, Any]]:
    player = find_policy_player(request["policy"])
    task = Task(request["variant"], ())
    rows = evaluate(player, task, request["opponents"], request["games"], request["seed"])
    return [{name: value for name, value in row.as_dict().items() if name != "score"} for row in rows]


if __name__ == "__main__":
    try:
        print(json.dumps(_play(json.loads(sys.argv[1]))))
    except (MemoryError, ImportError):  # of a library for which there is no room any more
        raise SystemExit("needs more memory than it may have") from None
    except ValueError as error:
        raise SystemExit(f"cannot play: {error}") from None
