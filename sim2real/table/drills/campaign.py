"""Hours of play with faults at random moments, in parts that can be taken up again."""

from __future__ import annotations

import json
import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import numpy as np

import sim2real
from sim2real.study.version import OF_GAMES, code_version
from sim2real.table.drills.drill import Drill, Stop
from sim2real.table.drills.known_faults import BY_NAME
from sim2real.table.faults import TableFaultError
from sim2real.table.game.robot_seat import make_robot_seat

PART = 120.0  # s of play of a part
BETWEEN = (1.0, 6.0)  # s of play between two faults
ROOT = Path(sim2real.__file__).parents[1]
BEGINS = b'{"seed": '  # a line of a part


@dataclass(frozen=True)
class Part:
    """A part of a campaign: its seed and `conditions`, as faults, player and code; seconds of play, what each fault
    did, the worst volts at a motor [V] and the farthest outside its area [m]; why it ended early, "" if it did
    not."""

    seed: int
    seconds: float
    stops: list[Stop]
    volts: float
    outside: float
    ended: str
    conditions: str


def play_part(seed: int, names: Sequence[str], player: str, camera: str) -> Part:
    """Play a part, with one fault after the other, drawn of those by `names`, before a camera of that kind."""
    random = np.random.default_rng([seed, 21])
    chosen = [BY_NAME[name] for name in names]
    env, stops, ended = make_robot_seat("puckpilot/match-v0", "twin", opponent="interceptor", camera=camera), [], ""
    try:
        drill = Drill(env, player, seed)
        try:
            while drill.seconds < PART:
                drill.play(float(random.uniform(*BETWEEN)))
                stops.append(drill.let_happen(chosen[random.integers(len(chosen))], float(random.uniform(0.0, 0.1))))
        except TableFaultError as error:
            ended = str(error)
        worst = drill.monitor.worst
        return Part(seed, drill.seconds, stops, worst.volts, worst.outside, ended, conditions(names, player, camera))
    finally:
        env.close()


def conditions(names: Sequence[str], player: str, camera: str) -> str:
    """What parts of one campaign have in common, the code that plays them among it."""
    return f"{player}, {camera}, code {code_version(ROOT, OF_GAMES)}: {', '.join(names)}"


def run_campaign(
    path: Path, seconds: float, seed: int, names: Sequence[str], player: str, camera: str, processes: int,
    report: Callable[[int, int], None],
) -> list[Part]:  # fmt: skip
    """Play parts until they have `seconds` of play; each is kept as a line of `path`, and those that are there already
    are not played again. `report` takes how many are done, of how many. ValueError for a file of something else."""
    _drop_cut_off_line(path)
    same = conditions(names, player, camera)
    done = {part.seed: part for part in read_parts(path)}
    if other := next((part.conditions for part in done.values() if part.conditions != same), None):
        raise ValueError(f"{path} has parts of another campaign, {other}; expected {same}: choose another --out")
    seeds = [seed + number for number in range(int(np.ceil(seconds / PART)))]
    missing = [one for one in seeds if one not in done]
    report(len(seeds) - len(missing), len(seeds))
    with ProcessPoolExecutor(processes) as pool, path.open("a", encoding="utf-8") as file:
        running = [pool.submit(play_part, one, names, player, camera) for one in missing]
        try:
            for number, result in enumerate(as_completed(running), 1):
                part = result.result()
                file.write(json.dumps(asdict(part)) + "\n")
                file.flush()
                done[part.seed] = part
                report(len(seeds) - len(missing) + number, len(seeds))
        except BaseException:
            pool.shutdown(wait=False, cancel_futures=True)
            raise
    return [done[one] for one in seeds]


def _drop_cut_off_line(path: Path) -> None:
    """Take from a file of parts a last line that has no end: a campaign was killed while it wrote it. A file of
    something else stays as it is."""
    whole = path.read_bytes() if path.exists() else b""
    last = whole[whole.rfind(b"\n") + 1 :]
    if last and (last.startswith(BEGINS) or BEGINS.startswith(last)):
        os.truncate(path, len(whole) - len(last))


def read_parts(path: Path) -> Iterator[Part]:
    """The parts in a file; none if it is not there. ValueError, in one line, for a file of something else."""
    if not path.exists():
        return
    for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), 1):
        try:
            row: dict[str, Any] = json.loads(line)
            row["stops"] = [Stop(**stop) for stop in row["stops"]]
            yield Part(**row)
        except (TypeError, KeyError, ValueError):
            raise ValueError(f"{path}, line {number}, is no part of a campaign; choose another file") from None
