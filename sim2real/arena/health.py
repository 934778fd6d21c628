"""How the arena's server keeps up: how late its ticks were, who is there, and its memory."""

from __future__ import annotations

import time
from pathlib import Path
from typing import Any

from sim2real.arena.lobby import Lobby


def health_of(lobby: Lobby) -> dict[str, Any]:
    """Games and pages that look on; of all ticks until now how many were over a period late, the latest [s], and what
    was not made up for [s]; processor time [s]; memory [bytes] now and at most, None where the system does not say."""
    lateness = lobby.lateness
    return {
        "games": lobby.games, "watchers": lobby.watchers,
        "ticks": lateness.steps, "late_ticks": lateness.late, "latest_s": round(lateness.latest, 4),
        "lost_s": round(lateness.lost, 4),
        "processor_s": round(time.process_time(), 3), "memory": _memory("VmRSS"), "most_memory": _memory("VmHWM"),
    }  # fmt: skip


def _memory(name: str) -> int | None:
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return None
    return next((1024 * int(line.split()[1]) for line in lines if line.startswith(f"{name}:")), None)
