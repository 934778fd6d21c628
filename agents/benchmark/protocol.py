"""The benchmark's protocol: what is played, how long one may train, and how a player is evaluated.

It is data, `protocol_v1.toml`, and frozen by a hash of that file's content and of the reference plays beside it (see
`reference_plays`), which hold the physics, the rules and the observations.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import Any

from agents.benchmark.reference_plays import PLAYS, digest_of_plays
from puckpilot_env.files.toml_file import check_format, read_toml
from puckpilot_env.game.start import MATCH
from puckpilot_env.variants import Variant, find_variant

FORMAT = "puckpilot-protocol/1"
FILE = Path(__file__).with_name("protocol_v1.toml")
ENTRIES = ("version", "seeds", "steps", "games", "evaluation_seed", "kept_out", "task")


@dataclass(frozen=True)
class Task:
    """A registered variant, by its id, and the opponents that one may train against; `name`: the id's last part."""

    variant: str
    opponents: tuple[str, ...]

    @property
    def name(self) -> str:
        """The id without its package, as in `match-v0`."""
        return self.variant.rsplit("/", 1)[-1]

    @property
    def is_match(self) -> bool:
        """Whether it is played from both seats; else it is a drill, in which player_0 is tested."""
        return self._found.game == MATCH

    @property
    def _found(self) -> Variant:
        return find_variant(self.variant)


@dataclass(frozen=True)
class Protocol:
    """The protocol; see the comments of its file. steps: budgets of training; tasks by name; hash: 16 hex digits."""

    version: int
    seeds: int
    steps: tuple[int, ...]
    games: int
    evaluation_seed: int
    kept_out: str
    tasks: Mapping[str, Task]
    hash: str

    def evaluated_against(self, task: Task) -> tuple[str, ...]:
        """The opponents of an evaluation: the task's, and the one that is kept out of all training."""
        return (*task.opponents, self.kept_out)

    def chosen(self, names: Sequence[str]) -> list[Task]:
        """The tasks of these names or ids, in the protocol's order; all of none. ValueError for an unknown one."""
        wanted = [name.rsplit("/", 1)[-1] for name in names]
        for name in wanted:
            if name not in self.tasks:
                raise ValueError(f"'{name}' is no task of the protocol; expected some of {', '.join(self.tasks)}")
        return [task for name, task in self.tasks.items() if name in wanted or not wanted]


@cache
def read_protocol(file: Path = FILE, plays: Path = PLAYS) -> Protocol:
    """The protocol of a file and its reference plays. ValueError, in one line, for a file that is none."""
    digest = digest_of_plays(plays)
    example = f'format = "{FORMAT}"'
    return read_toml(file, "the protocol", FILE.name, example, lambda content: _protocol(content, digest))


def _protocol(content: Mapping[str, Any], plays: str) -> Protocol:
    check_format(content, FORMAT, ENTRIES)
    tasks = [Task(one["variant"], tuple(one["opponents"])) for one in content["task"]]
    digest = hashlib.sha256(json.dumps([content, plays], sort_keys=True).encode()).hexdigest()
    return Protocol(
        **{name: content[name] for name in ENTRIES if name not in ("steps", "task")},
        steps=tuple(content["steps"]),
        tasks={task.name: task for task in tasks},
        hash=digest[:16],
    )
