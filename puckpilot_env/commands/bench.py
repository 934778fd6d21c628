"""How fast the simulator is on this machine.

By default one batch of tables plays random actions, drawn beforehand, with all observation and reward work; the figure
is the median over many short stretches, since machines are noisy. --dicts measures one table behind PettingZoo's
dictionaries; --startup how long a fresh process takes from `import puckpilot_env` to its first step.
"""

from __future__ import annotations

import argparse
import json
import os
import subprocess
import sys
import tempfile
import time
from typing import Any

import numpy as np

DRAWN = 16  # different batches of actions
WARM_UP = 100  # steps, so that matches are under way
STRETCHES = 30
DICT_STEPS = 400  # a stretch of one table
FIRST_STEP = (
    "import time; t = time.perf_counter(); import puckpilot_env, pettingzoo; "
    "env = pettingzoo.make('parallel', '{id}'); env.reset(seed=0); "
    "env.step({{a: env.action_space(a).sample() for a in env.agents}}); print(time.perf_counter() - t)"
)


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("id", nargs="?", default="puckpilot/match-v0", metavar="ID", help="variant (match-v0)")
    parser.add_argument("--tables", type=int, default=2048, help="tables at once (2048)")
    parser.add_argument("--threads", type=int, default=1, help="threads that share them (1)")
    parser.add_argument("--seconds", type=float, default=5.0, help="how long to measure (5)")
    parser.add_argument("--against", metavar="ID", help="measure this variant too, in turn, and print the ratio")
    parser.add_argument("--effects", metavar="FILE", help="physics beyond the baseline on the first variant's tables")
    parser.add_argument("--draws", metavar="FILE", help="what differs from table to table there, from a file")
    instead = parser.add_mutually_exclusive_group()
    instead.add_argument("--dicts", action="store_true", help="one table behind PettingZoo's dictionaries instead")
    instead.add_argument("--startup", action="store_true", help="a fresh process to its first step instead")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Measure and print; 0. Raises ValueError, in one line, for an unknown id or an impossible size."""
    from puckpilot_env.variants import find_variant

    if not 0.0 < args.seconds <= 3600.0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 3600")
    variant = find_variant(args.id)
    rivals = [variant] + ([find_variant(args.against)] if args.against else [])
    if args.startup:
        report = _startup(variant.id)
    elif args.dicts:
        report = _dicts(variant, args.seconds)
    else:
        report = _batches(rivals, args.tables, args.threads, args.seconds, args.effects, args.draws)
    if args.json:
        print(json.dumps(report, indent=1))
    else:
        width = max(map(len, report))
        for key, value in report.items():
            print(
                f"{key:{width}}  {value:,.0f}"
                if isinstance(value, float) and value > 1e3
                else f"{key:{width}}  {value}"
            )
    return 0


def _batches(
    variants: list[Any], tables: int, threads: int, seconds: float, effects: str | None = None, draws: str | None = None
) -> dict[str, Any]:
    """Median speed of the first variant. Of a second one, and of one thread beside several, the median ratio of
    stretches measured in turn."""
    from puckpilot_env.tables import Tables

    given: list[dict[str, Any]] = [{"effects": effects, "draws": draws}, {}]
    batches = [
        Tables(v, tables, seed=1, threads=threads, **options) for v, options in zip(variants, given, strict=False)
    ]
    if threads > 1:
        batches.append(Tables(variants[0], tables, seed=1, **given[0]))
    actions = [_draw_actions(batch) for batch in batches]
    for batch, drawn in zip(batches, actions, strict=True):
        for step in range(WARM_UP):
            batch.step(drawn[step % DRAWN])
    share = seconds / (STRETCHES * len(batches))
    speeds = np.array(
        [[_speed(batch, drawn, share) for batch, drawn in zip(batches, actions, strict=True)] for _ in range(STRETCHES)]
    )
    for batch in batches:
        batch.close()
    speed = float(np.median(speeds[:, 0]))
    report = {
        "id": variants[0].id,
        "tables": tables,
        "threads": threads,
        "agent_steps_per_s": speed,
        "table_seconds_per_s": speed / 2.0 * variants[0].period,
        "fastest_stretch": float(speeds[:, 0].max()),
    }
    if len(variants) > 1:
        report |= {"against": variants[1].id, "ratio": round(float(np.median(speeds[:, 0] / speeds[:, 1])), 4)}
    if threads > 1:
        report["times_one_thread"] = round(float(np.median(speeds[:, 0] / speeds[:, -1])), 4)
    return report


def _draw_actions(batch: Any) -> list[np.ndarray]:
    rng = np.random.default_rng(0)
    low, high = batch.action_bounds
    drawn = rng.uniform(low, high, (DRAWN, len(batch), 2, 4)).astype(np.float32)
    return list(np.clip(drawn, low, high))


def _speed(batch: Any, actions: list[np.ndarray], seconds: float) -> float:
    """Agent-steps per second over a stretch of about `seconds`."""
    steps, start = 0, time.perf_counter()
    while (passed := time.perf_counter() - start) < seconds or steps == 0:
        batch.step(actions[steps % DRAWN])
        steps += 1
    return 2.0 * len(batch) * steps / passed


def _dicts(variant: Any, seconds: float) -> dict[str, Any]:
    from puckpilot_env.adapters.parallel_env import TableEnv

    env = TableEnv(variant)
    env.reset(seed=1)
    actions = {agent: env.action_space(agent).sample() for agent in env.agents}
    env.step(actions)  # so that no compilation is measured
    speeds, end = [], time.perf_counter() + seconds
    while time.perf_counter() < end:
        start = time.perf_counter()
        for _ in range(DICT_STEPS):
            if not env.agents:
                env.reset()
            env.step(actions)
        speeds.append(2.0 * DICT_STEPS / (time.perf_counter() - start))
    return {
        "id": variant.id,
        "tables": 1,
        "agent_steps_per_s": float(np.median(speeds)),
        "interface": "PettingZoo dicts",
    }


def _startup(id_: str) -> dict[str, Any]:
    """Seconds of a fresh process with an empty and with a warm kernel cache; of the warm one the median of five."""
    with tempfile.TemporaryDirectory() as cache:
        cold = _first_step(id_, cache)
        warm = [_first_step(id_, cache) for _ in range(5)]
    return {"id": id_, "cold_start_s": round(cold, 3), "warm_start_s": round(float(np.median(warm)), 3)}


def _first_step(id_: str, cache: str) -> float:
    done = subprocess.run(
        [sys.executable, "-c", FIRST_STEP.format(id=id_)],
        env={**os.environ, "XDG_CACHE_HOME": cache},
        capture_output=True,
        text=True,
        check=True,
    )
    return float(done.stdout)
