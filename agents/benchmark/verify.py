"""Whether an entry of the leaderboard holds: its files, its protocol, and what it claims, played anew.

A claim is refuted where it is more than its policy reaches in new games, of seeds that the entry did not know: by
Fisher's exact test of the games won, and of those not lost, at SIGNIFICANCE over all claims together (Bonferroni). The
two games of a pair may come out alike, so that a match's count as half as many.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from scipy.stats import fisher_exact

from agents.benchmark.entry import FILE, Claim, Entry, digest, tasks_claimed
from agents.benchmark.evaluation import Against
from agents.benchmark.protocol import Protocol, Task
from agents.benchmark.reference_plays import departures
from agents.benchmark.sandbox import Limits, SandboxError, play_in_sandbox

SIGNIFICANCE = 1e-3  # chance that an honest entry is refused
TESTS = 2  # of a claim: games won, games not lost


@dataclass(frozen=True)
class Finding:
    """One thing that was checked: whether it holds, and words for it."""

    what: str
    holds: bool
    words: str


def verify(
    entry: Entry, protocol: Protocol, games: int, seed: int, limits: Limits | None = None,
    report: Callable[[Finding], None] = lambda finding: None,
) -> list[Finding]:  # fmt: skip
    """Check an entry, with so many games of each claim; `report` takes each finding as it is made.

    Nothing is played where the entry is of another protocol, this version plays another game, or a file is not the one
    that was entered. ValueError, in one line, for an entry that claims what the protocol does not have.
    """
    tasks = tasks_claimed(entry, protocol)
    findings: list[Finding] = []

    def add(finding: Finding) -> None:
        findings.append(finding)
        report(finding)

    for finding in (_protocol(entry, protocol), _game(), *_files(entry)):
        add(finding)
    if not all(one.holds for one in findings):
        return findings
    for task in tasks:
        for finding in _task(entry, task, protocol, games, seed, limits or Limits()):
            add(finding)
    return findings


def _protocol(entry: Entry, protocol: Protocol) -> Finding:
    same = entry.protocol == protocol.hash
    return Finding("protocol", same, entry.protocol if same else f"{entry.protocol}, here is {protocol.hash}")


def _game() -> Finding:
    found = departures()
    return Finding("game", not found, found[0] if found else "this version plays the protocol's")


def _files(entry: Entry) -> Iterator[Finding]:
    beside = {one.name for one in entry.folder.iterdir() if (match := FILE.fullmatch(one.name)) and
              match["name"] == entry.name}  # fmt: skip
    for name, expected in entry.files.items():
        path = entry.folder / name
        if not path.is_file():
            yield Finding(name, False, "is not there")
        else:
            same = digest(path) == expected
            yield Finding(name, same, "as it was entered" if same else "is not the file that was entered")
    for name in sorted(beside - set(entry.files)):
        yield Finding(name, False, "is not listed in the entry")


def _task(entry: Entry, task: Task, protocol: Protocol, games: int, seed: int, limits: Limits) -> Iterator[Finding]:
    try:
        played = {row.opponent: row for row in play_in_sandbox(entry.policy, task, protocol, games, seed, limits)}
    except SandboxError as error:
        yield Finding(task.name, False, str(error))
        return
    for claim in entry.claims_of(task.name):
        yield _claim(claim, played[claim.opponent], SIGNIFICANCE / (TESTS * len(entry.claims)))


def _claim(claim: Claim, played: Against, level: float) -> Finding:
    won = overstated((claim.won, claim.games), (played.won, played.games), played.is_match, level)
    kept = overstated(
        (claim.games - claim.lost, claim.games), (played.games - played.lost, played.games), played.is_match, level
    )
    words = (
        f"claimed {claim.won} won and {claim.lost} lost of {claim.games}; "
        f"played {played.won} and {played.lost} of {played.games}"
    )
    return Finding(f"{claim.task} against {claim.opponent}", not (won or kept), words)


def overstated(claimed: tuple[int, int], played: tuple[int, int], paired: bool, level: float) -> bool:
    """Whether a share that was claimed, as hits and games, is more than was played, at a level of significance."""
    table = [[hits, games - hits] for hits, games in (claimed, played)]
    if paired:
        table = [[round(0.5 * count) for count in row] for row in table]
    _, p_value = np.array(fisher_exact(table, alternative="greater"))
    return bool(p_value < level)


def entry_file(name: Path) -> Path:
    """The entry's file of a path, with or without its ending."""
    return name if name.suffix == ".toml" else name.with_suffix(".toml")
