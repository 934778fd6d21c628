"""All that `puckpilot bench arena` measures, of an arena in a process of its own."""

from __future__ import annotations

import asyncio
import os
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from sim2real.arena.bench import load, pictures
from sim2real.arena.bench.bad_line import bad_line

DELAYS = (0.0, 0.1, 0.2)  # s each way
LOSS = 0.05
GAMES, WATCHERS = 4, 20
Progress = Callable[[int, int], None]


@contextmanager
def arena(player: str) -> Iterator[str]:
    """The address of an arena whose recordings do not stay. ValueError, in one line, if it does not start."""
    pipe = subprocess.PIPE
    command = [sys.executable, "-m", "puckpilot", "arena", player, "--port", "0"]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen([*command, "--out", folder], stdout=pipe, stderr=pipe, text=True) as process,
    ):
        try:
            assert process.stdout is not None and process.stderr is not None
            if not (said := process.stdout.readline().split()):
                raise ValueError(f"no arena starts here: {process.stderr.read().strip()}")
            yield said[0]
        finally:
            process.terminate()


async def measure(player: str, leaps: int, seconds: float, seed: int, progress: Progress) -> dict[str, Any]:
    """Everything, as a JSON object; without a browser `no_browser` says why there are no pictures."""
    result: dict[str, Any] = {"player": player, "loss": LOSS, "lines": []}
    with arena(player) as address:
        try:
            async with pictures.browser() as opened:
                for k, delay in enumerate(DELAYS):
                    progress(k, len(DELAYS) + 1)
                    result["lines"].append(await _line(opened, address, delay, leaps, seed + k))
        except pictures.NoBrowserError as error:
            result["no_browser"] = str(error)
    with arena(player) as address:
        progress(len(DELAYS), len(DELAYS) + 1)
        before = _stolen()
        rates, core = await load.rates(address, GAMES, WATCHERS, seconds)
        after = _stolen()
        result["load"] = {
            "games": GAMES, "watchers": WATCHERS, "seconds": seconds,
            "states_a_second": {"median": float(np.median(rates)), "least": min(rates)},
            "cores": core, "stolen_s": None if before is None or after is None else round(after - before, 2),
            "server": await load.health(address),
        }  # fmt: skip
    result["machine_load"] = os.getloadavg()[0] if hasattr(os, "getloadavg") else None
    return result


def _stolen() -> float | None:
    """Steal time [s] until now, in which the host of a virtual machine ran others; None where that is not known."""
    try:
        return int(Path("/proc/stat").read_text().split(maxsplit=9)[8]) / os.sysconf("SC_CLK_TCK")
    except (OSError, IndexError, ValueError):
        return None


async def _line(opened: Any, address: str, delay: float, leaps: int, seed: int) -> dict[str, Any]:
    """What a page shows behind a line."""
    port = int(address.split(":")[2].split("/")[0])
    async with bad_line(port, delay, LOSS, seed) as entry:
        seen = await pictures.watched(opened, address.replace(f":{port}/", f":{entry}/"), leaps, seed)
    delays = seen.delays()
    if not delays:
        raise ValueError(f"none of {leaps} leaps was seen in a picture; give more --leaps")
    jump, farthest = await asyncio.to_thread(seen.beyond)
    return {
        "delay_s": delay, "leaps": len(delays), "pictures": len(seen.pictures),
        "median_s": float(np.median(delays)), "p99_s": float(np.percentile(delays, 99)),
        "jump_m": jump, "farthest_m": farthest, "placed": len(seen.placed),
    }  # fmt: skip
