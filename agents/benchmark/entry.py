"""An entry of the leaderboard: a TOML file beside a policy, with what the policy is claimed to reach.

The policy is data, never code: NAME.npz or NAME.onnx, and NAME.TASK.npz beside it for tasks that have one of their own,
as players by name have them (see `agents.policy.policy.variant_file`). The entry has the digest of each.
"""

from __future__ import annotations

import hashlib
import json
import re
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents.benchmark.evaluation import Against
from agents.benchmark.protocol import Protocol, Task
from agents.policy.policy import MOST_BYTES, policy_file, variant_file
from puckpilot_env.files.small_file import check_regular
from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown
from puckpilot_env.files.whole_file import write_text_whole, write_whole
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


def digest(content: bytes) -> str:
    """SHA-256 of a file's content."""
    return hashlib.sha256(content).hexdigest()


def read_policy_file(file: Path) -> bytes:
    """The content of a file of a policy. ValueError for one that is too large, a link, a device or a pipe; OSError
    where it cannot be read."""
    if file.is_symlink():
        raise ValueError(f"{file} is a link")
    check_regular(file, MOST_BYTES)
    return file.read_bytes()


def copy_policy(player: str, name: str, tasks: Iterable[Task], folder: Path) -> dict[str, bytes]:
    """Copy a player's policy, and its files for these tasks, into a folder, as those of an entry of this name; their
    contents by name. ValueError, in one line, for a name that is none, and for a player that is no policy."""
    if not NAME.fullmatch(name):
        raise ValueError(f"--name is {in_short(name)}; expected letters, digits, - and _, at most 40")
    whole = policy_file(player)
    sources = {f"{name}{whole.suffix}": whole}
    for task in tasks:
        own = variant_file(whole, task.name)
        if own != whole:
            sources[f"{name}.{task.name}{whole.suffix}"] = own
    contents = {target: source.read_bytes() for target, source in sources.items()}
    for target, content in contents.items():
        write_whole(folder / target, lambda draft, content=content: draft.write_bytes(content))
    return contents


def write_entry(
    name: str, trained: str, protocol: Protocol, played: Mapping[str, Sequence[Against]], contents: Mapping[str, bytes],
    folder: Path,
) -> Path:  # fmt: skip
    """Write an entry with its policy's files, by name, and what was `played` of each task; the entry's path. Files of
    an earlier policy of this name are removed."""
    folder.mkdir(parents=True, exist_ok=True)
    for old in files_of(name, folder) - set(contents):
        (folder / old).unlink()
    for target, content in contents.items():
        write_whole(folder / target, lambda draft, content=content: draft.write_bytes(content))
    lines = [f'format = "{FORMAT}"', f"name = {json.dumps(name)}", f"trained = {json.dumps(trained)}"]
    lines += [f'protocol = "{protocol.hash}"', "", "[files]"]
    lines += [f'"{target}" = "{digest(content)}"' for target, content in contents.items()]
    for task, rows in played.items():
        for row in rows:
            lines += ["", "[[claim]]", f'task = "{task}"', f'opponent = "{row.opponent}"']
            lines += [f"{part} = {getattr(row, part)}" for part in ("games", "won", "lost")]
    return write_text_whole(folder / f"{name}.toml", "\n".join(lines) + "\n")


def files_of(name: str, folder: Path) -> set[str]:
    """Names of the files in a folder that would play as the policy of this name."""
    found = {one.name: FILE.fullmatch(one.name) for one in folder.iterdir()}
    return {one for one, match in found.items() if match and match["name"] == name}


def tasks_claimed(entry: Entry, protocol: Protocol) -> list[Task]:
    """The tasks of the protocol of which the entry claims something. ValueError, in one line, for another, where an
    opponent of the evaluation is left out or is none of them, and for claims of fewer games, which prove nothing."""
    for name in entry.tasks:
        refuse_unknown([name], protocol.tasks, "task")
    tasks = protocol.chosen(entry.tasks)
    for task in tasks:
        claimed = [claim.opponent for claim in entry.claims_of(task.name)]
        expected = protocol.evaluated_against(task)
        if sorted(claimed) != sorted(expected):
            raise ValueError(f"{task.name} is claimed against {', '.join(claimed)}; expected {', '.join(expected)}")
        if other := [claim.games for claim in entry.claims_of(task.name) if claim.games != protocol.games]:
            raise ValueError(f"{task.name} is claimed of {other[0]} games; expected {protocol.games}")
    return tasks
