"""Data-parallel training in several processes (torchrun): each has its own tables, and all the same network and league.

rsl-rl averages the gradients. Results of games are summed over processes here, so that the league of every process sees
the same results and, with the same random numbers, makes the same choices.
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
    """Rank of this process; 0 for the one that writes files, and without torchrun."""
    return int(os.environ.get("RANK", "0"))


def world_size() -> int:
    """Number of processes; 1 without torchrun."""
    return int(os.environ.get("WORLD_SIZE", "1"))


def local_device(device: str) -> str:
    """The torch device of this process: for "cuda" the GPU of its local rank, else `device`."""
    return f"cuda:{os.environ.get('LOCAL_RANK', '0')}" if device == "cuda" else device


def init_process_group(device: str) -> dict[str, int] | None:
    """Connect the processes; returns rsl-rl's "multi_gpu" configuration, None for a single process.

    The backend is NCCL for networks on GPUs, else gloo. Results of games are on the CPU and always use gloo. rsl-rl 5.5
    by itself would set up NCCL alone and refuse the CPU.
    """
    if world_size() == 1:
        return None
    if not dist.is_initialized():
        dist.init_process_group("cpu:gloo,cuda:nccl" if device.startswith("cuda") else "gloo")
        # Its threads must end before the interpreter: one that frees a tensor afterwards crashes the process.
        atexit.register(dist.destroy_process_group)
    if device.startswith("cuda"):
        torch.cuda.set_device(device)
    return {"global_rank": rank(), "local_rank": int(os.environ.get("LOCAL_RANK", "0")), "world_size": world_size()}


def gather(value: Any) -> list[Any]:
    """The `value` of every process by rank, on rank 0; an empty list on the others. All processes must call it."""
    if world_size() == 1:
        return [value]
    everyone = [None] * world_size() if rank() == 0 else None
    dist.gather_object(value, everyone)
    return everyone or []


def sum_over_processes(counts: NDArray[np.float64]) -> NDArray[np.float64]:
    """The elementwise sum of all processes' `counts`, on every process. All processes must call it."""
    if world_size() == 1:
        return counts
    total = torch.from_numpy(np.ascontiguousarray(counts, np.float64))
    dist.all_reduce(total)
    return total.numpy()
