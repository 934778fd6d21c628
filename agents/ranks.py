"""One training in several processes (torchrun): the same network and league on all, tables of their own on each.

Gradients are averaged by rsl-rl; what comes of the games is added up here, so that every process's league sees the same
results and, with the same random numbers, takes the same decisions.
"""

from __future__ import annotations

import atexit
import os
from typing import Any

import numpy as np
import torch
import torch.distributed as dist
from numpy.typing import NDArray


def rank() -> int:
    """This process's number; 0 without torchrun, and for the one that writes files."""
    return int(os.environ.get("RANK", "0"))


def world() -> int:
    """How many processes there are; 1 without torchrun."""
    return int(os.environ.get("WORLD_SIZE", "1"))


def own_device(device: str) -> str:
    """Of several processes on a machine's GPUs each has its own."""
    return f"cuda:{os.environ.get('LOCAL_RANK', '0')}" if device == "cuda" else device


def join(device: str) -> dict[str, int] | None:
    """Meet the other processes, over NCCL where networks are on GPUs, else over gloo; rsl-rl's description of them,
    None if alone. What comes of the games is on processors, and so goes over gloo in any case.

    rsl-rl 5.5 would set up NCCL alone, and so refuses processors.
    """
    if world() == 1:
        return None
    if not dist.is_initialized():
        dist.init_process_group("cpu:gloo,cuda:nccl" if device.startswith("cuda") else "gloo")
        # Its threads must end before the interpreter does: one that frees a tensor later takes the process with it.
        atexit.register(dist.destroy_process_group)
    if device.startswith("cuda"):
        torch.cuda.set_device(device)
    return {"global_rank": rank(), "local_rank": int(os.environ.get("LOCAL_RANK", "0")), "world_size": world()}


def gathered(mine: Any) -> list[Any]:
    """What every process has of this, in the order of their numbers, for the first; nothing for the others."""
    if world() == 1:
        return [mine]
    everyone = [None] * world() if rank() == 0 else None
    dist.gather_object(mine, everyone)
    return everyone or []


def added(counts: NDArray[np.float64]) -> NDArray[np.float64]:
    """The sum of all processes' counts."""
    if world() == 1:
        return counts
    total = torch.from_numpy(np.ascontiguousarray(counts, np.float64))
    dist.all_reduce(total)
    return total.numpy()
