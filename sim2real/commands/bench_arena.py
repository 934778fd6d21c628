"""How quick the arena is here, and what it bears.

A page in headless Chromium plays behind a line that takes 0, 100 and 200 ms each way and loses 5 % of the packets, as
TCP shows it: what is lost comes again after 200 ms and a round trip, and all behind it waits. Its pointer goes in
circles, then leaps. From each leap to the picture that shows it is the first figure; the next are how far the own
mallet jumps between two pictures, and how far it is off, beyond the motion that the simulator's gantry has after the
same aims. Then 4 people play and 20 pages look on. Without Chromium, or without playwright, the first part is left out.
"""

from __future__ import annotations

import argparse
import json
from typing import Any

MOST_LEAPS, MOST_SECONDS = 10_000, 86_400.0


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("player", nargs="?", default="policy:champion", metavar="PLAYER", help="(policy:champion)")
    parser.add_argument("--leaps", type=int, default=200, metavar="N", help="of the pointer, for each line (200)")
    parser.add_argument("--seconds", type=float, default=300.0, metavar="S", help="with many pages (300)")
    parser.add_argument("--seed", type=int, default=0, help="of what is lost, and where the pointer goes (0)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Measure and print; 0. ValueError, in one line, for an unknown player or an impossible option."""
    import asyncio

    from baselines import find_player
    from baselines.commands.options import progress_bar
    from puckpilot_env.options.inputs import seed_number, whole_number
    from sim2real.arena.bench.measure import measure

    whole_number(args.leaps, "--leaps", 1, MOST_LEAPS)
    if not 1.0 <= args.seconds <= MOST_SECONDS:
        raise ValueError(f"--seconds is {args.seconds:g}; expected 1 to {MOST_SECONDS:g}")
    find_player(args.player)
    with progress_bar("lines, then many pages") as progress:
        result = asyncio.run(measure(args.player, args.leaps, args.seconds, seed_number(args.seed), progress))
    print(json.dumps(result, indent=1) if args.json else "\n".join(lines_of(result)))
    return 0


def lines_of(result: dict[str, Any]) -> list[str]:
    """What was measured, for a terminal."""
    from sim2real.columns import aligned

    lines = []
    if "no_browser" in result:
        lines.append(f"from the pointer to the picture: not measured, {result['no_browser']}")
    else:
        rows = [("delay each way", "median", "99 %", "largest jump", "farthest", "of the mallet beyond its own motion")]
        rows += [
            (
                f"{1e3 * one['delay_s']:.0f} ms", f"{1e3 * one['median_s']:.1f} ms", f"{1e3 * one['p99_s']:.1f} ms",
                f"{1e3 * one['jump_m']:.1f} mm", f"{1e3 * one['farthest_m']:.1f} mm",
                f"{one['leaps']} leaps, {one['pictures']} pictures",
            )
            for one in result["lines"]
        ]  # fmt: skip
        lines += ["from the pointer to the picture", *aligned(rows), ""]
    load = result["load"]
    server, states = load["server"], load["states_a_second"]
    memory = "" if server["most_memory"] is None else f", {server['most_memory'] / 2**20:.0f} MB of memory at most"
    busy = "" if result["machine_load"] is None else f", the machine's load was {result['machine_load']:.1f}"
    stolen = "" if load["stolen_s"] is None else f", steal time {load['stolen_s']:g} s"
    return [
        *lines,
        f"{load['games']} games and {load['watchers']} who look on, {load['seconds']:g} s: to each page "
        f"{states['median']:.1f} states a second, {states['least']:.1f} at least",
        f"the latest of {server['ticks']} ticks {1e3 * server['latest_s']:.1f} ms behind its deadline, "
        f"{server['late_ticks']} over a tick, {server['lost_s']:g} s lost{stolen}",
        f"the server took {load['cores']:.2f} of a core{memory}{busy}",
    ]
