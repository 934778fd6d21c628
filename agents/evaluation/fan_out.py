"""Independent jobs in parallel: in local processes, or on the machines of a Ray cluster."""

from __future__ import annotations

import logging
import os
import socket
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")
CONNECTING = 5.0  # s until a cluster's address counts as wrong


def fan_out(
    work: Callable[[Job], Result], jobs: Sequence[Job], *, workers: int = 1, cluster: str | None = None
) -> Iterator[Result]:
    """Yield the results of `work` on each of `jobs`, in the order of `jobs`.

    `cluster` is the address of a Ray cluster ("local" starts one here), which decides how many jobs run at once.
    Without it `workers` processes run; one worker is this process. `work` must be a module's function.
    ValueError, in one line, where Ray is not installed or its cluster cannot be reached.
    """
    if cluster is not None:
        yield from _on_ray(work, jobs, cluster)
    elif workers == 1:
        yield from map(work, jobs)
    else:
        with ProcessPoolExecutor(workers, mp_context=get_context("spawn")) as pool:
            yield from pool.map(work, jobs)


def _on_ray(work: Callable[[Job], Result], jobs: Sequence[Job], cluster: str) -> Iterator[Result]:
    os.environ.setdefault("RAY_ACCEL_ENV_VAR_OVERRIDE_ON_ZERO", "0")  # else Ray warns about GPUs
    try:
        import ray
    except ImportError:
        raise ValueError("--cluster needs Ray; install it with: pip install 'puckpilot[cluster]'") from None
    _refuse_unreachable(cluster)
    try:
        ray.init(address=None if cluster == "local" else cluster, log_to_driver=False, logging_level=logging.ERROR)
    except (ConnectionError, RuntimeError, ValueError) as error:
        raise ValueError(f"no Ray cluster at {cluster}: {str(error).splitlines()[0]}") from None
    try:
        # A lambda, since Ray refuses functions written in C, and its type stubs refuse generic ones.
        remote = ray.remote(lambda job: work(job))  # pyright: ignore[reportArgumentType] - see above
        yield from (ray.get(one) for one in [remote.remote(job) for job in jobs])
    finally:
        ray.shutdown()


def _refuse_unreachable(cluster: str) -> None:
    """ValueError, in one line, if nothing listens at an address host:port; Ray itself asks for two minutes."""
    host, colon, port = cluster.removeprefix("ray://").rpartition(":")
    if not colon:
        return  # a word that Ray knows, as `local`
    try:
        socket.create_connection((host.strip("[]"), int(port)), CONNECTING).close()
    except (OSError, ValueError, OverflowError) as error:
        raise ValueError(f"no Ray cluster at {cluster}: {error}; expected host:port, or local") from None
