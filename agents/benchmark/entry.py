"""An entry of the leaderboard: a TOML file beside a policy, with what the policy is claimed to reach.

The policy is data, never code: NAME.npz or NAME.onnx, and NAME.TASK.npz beside it for tasks that have one of their own,
as players by name have them (see `agents.policy.policy.variant_file`). The entry has the digest of each.
"""

from __future__ import annotations

import hashlib
import json
import re
import shutil
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents.benchmark.evaluation import Against
from agents.benchmark.protocol import Protocol, Task
from agents.policy.policy import policy_file, variant_file
from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown
from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.options.inputs import in_short

FORMAT = "puckpilot-entry/1"
ENTRIES = ("name", "trained", "protocol", "files", "claim")
CLAIM = ("task", "opponent", "games", "won", "lost")
NAME = re.compile(r"[A-Za-z0-9_-]{1,40}")
FILE = re.compile(r"(?P<name>[A-Za-z0-9_-]{1,40})(\.[a-z0-9-]{1,40})?\.(npz|onnx)")


@dataclass(frozen=True)
class Claim:
    """What a policy is said to reach in a task against an opponent; see `Against`."""

    task: str
    opponent: str
    games: int
    won: int
    lost: int


@dataclass(frozen=True)
class Entry:
    """name: of the entry and its policy; trained: how, in words; protocol: the hash of that which it was evaluated by;
    files: their SHA-256 by name; folder: where they are."""

    name: str
    trained: str
    protocol: str
    files: Mapping[str, str]
    claims: Sequence[Claim]
    folder: Path

    @property
    def policy(self) -> Path:
        """The policy's file, which stands beside the entry's."""
        return self.folder / next(file for file in policy_files(self.name) if file in self.files)

    @property
    def tasks(self) -> list[str]:
        """The tasks of which something is claimed."""
        return list(dict.fromkeys(claim.task for claim in self.claims))

    def claims_of(self, task: str) -> list[Claim]:
        """Those of one task."""
        return [claim for claim in self.claims if claim.task == task]


def read_entry(file: Path) -> Entry:
    """An entry of the leaderboard. ValueError, in one line, for a file that is none."""
    example = f'format = "{FORMAT}" and [[claim]]'
    return read_toml(file, "an entry", "leaderboard/NAME.toml", example, lambda content: _entry(content, file))


def _entry(content: Mapping[str, Any], file: Path) -> Entry:
    check_format(content, FORMAT, ENTRIES)
    if missing := [name for name in ENTRIES if name not in content]:
        raise ValueError(f"there is no {missing[0]}; expected {', '.join(ENTRIES)}")
    for name in ("name", "trained", "protocol"):
        if not isinstance(content[name], str):
            raise ValueError(f"{name} is {in_short(content[name])}; expected text")
    if not NAME.fullmatch(content["name"]) or content["name"] != file.stem:
        raise ValueError(f"name is {in_short(content['name'])}; expected that of the file, {file.stem}")
    files = content["files"]
    whole = policy_files(content["name"])
    if not isinstance(files, Mapping) or not all(FILE.fullmatch(name) for name in files):
        raise ValueError(f"files is {in_short(files)}; expected the SHA-256 of {' or '.join(whole)} by its name")
    if sum(name in files for name in whole) != 1:
        raise ValueError(f"files has {in_short(list(files))}; expected either {' or '.join(whole)}, the policy")
    claims = content["claim"]
    if not isinstance(claims, list) or not claims:
        raise ValueError(f"claim is {in_short(claims)}; expected one [[claim]] or more")
    return Entry(
        content["name"], content["trained"], content["protocol"], files, [_claim(one) for one in claims], file.parent
    )


def _claim(one: Any) -> Claim:
    if not isinstance(one, Mapping):
        raise ValueError(f"a claim is {in_short(one)}; expected {', '.join(CLAIM)}")
    refuse_unknown(one, CLAIM, "entry of a claim")
    if missing := [name for name in CLAIM if name not in one]:
        raise ValueError(f"a claim has no {missing[0]}; expected {', '.join(CLAIM)}")
    counts = [one[name] for name in ("games", "won", "lost")]
    if not all(type(count) is int and count >= 0 for count in counts) or sum(counts[1:]) > counts[0] or not counts[0]:
        raise ValueError(f"a claim is of {in_short(counts)} games, won and lost; expected whole numbers that fit")
    return Claim(str(one["task"]), str(one["opponent"]), *counts)


def policy_files(name: str) -> tuple[str, str]:
    """What the file of an entry's policy may be named."""
    return f"{name}.npz", f"{name}.onnx"


def digest(file: Path) -> str:
    """SHA-256 of a file."""
    return hashlib.sha256(file.read_bytes()).hexdigest()


def write_entry(
    name: str, player: str, trained: str, protocol: Protocol, played: Mapping[str, Sequence[Against]], folder: Path
) -> Path:
    """Write an entry, and beside it the policy of a player with its files for the tasks that were `played`; the
    entry's path. ValueError, in one line, for a name that is none, and for a player that is no policy."""
    if not NAME.fullmatch(name):
        raise ValueError(f"--name is {in_short(name)}; expected letters, digits, - and _, at most 40")
    whole = policy_file(player)
    found = {whole: f"{name}{whole.suffix}"}
    for task in played:
        own = variant_file(whole, task)
        found.setdefault(own, f"{name}.{task}{whole.suffix}")
    folder.mkdir(parents=True, exist_ok=True)
    for source, target in found.items():
        if source.resolve() != (folder / target).resolve():
            shutil.copyfile(source, folder / target)
    lines = [f'format = "{FORMAT}"', f"name = {json.dumps(name)}", f"trained = {json.dumps(trained)}"]
    lines += [f'protocol = "{protocol.hash}"', "", "[files]"]
    lines += [f'"{target}" = "{digest(folder / target)}"' for target in found.values()]
    for task, rows in played.items():
        for row in rows:
            lines += ["", "[[claim]]", f'task = "{task}"', f'opponent = "{row.opponent}"']
            lines += [f"{part} = {getattr(row, part)}" for part in ("games", "won", "lost")]
    path = folder / f"{name}.toml"
    write_text_whole(path, "\n".join(lines) + "\n")
    return path


def tasks_claimed(entry: Entry, protocol: Protocol) -> list[Task]:
    """The tasks of the protocol of which the entry claims something. ValueError, in one line, for another, where an
    opponent of the evaluation is left out or is none of them, and for claims of fewer games, which prove nothing."""
    tasks = protocol.chosen(entry.tasks)
    for task in tasks:
        claimed = [claim.opponent for claim in entry.claims_of(task.name)]
        expected = protocol.evaluated_against(task)
        if sorted(claimed) != sorted(expected):
            raise ValueError(f"{task.name} is claimed against {', '.join(claimed)}; expected {', '.join(expected)}")
        if other := [claim.games for claim in entry.claims_of(task.name) if claim.games != protocol.games]:
            raise ValueError(f"{task.name} is claimed of {other[0]} games; expected {protocol.games}")
    return tasks
