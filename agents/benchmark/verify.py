"""Whether an entry of the leaderboard holds: its files, its protocol, and what it claims, played anew.

A claim is refuted where it is more than its policy reaches in new games, of seeds that the entry did not know: by
Fisher's exact test of the games won, and of those not lost, at SIGNIFICANCE over all claims together (Bonferroni). The
two games of a pair may come out alike, so that a match's count as half as many.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np
from scipy.stats import fisher_exact

from agents.benchmark import LEADERBOARD
from agents.benchmark.entry import Claim, Entry, digest, files_of, read_policy_file, tasks_claimed
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

    with TemporaryDirectory(prefix="puckpilot-entry-") as private:
        for finding in (_protocol(entry, protocol), _game(), *_files(entry, Path(private))):
            add(finding)
        if not all(one.holds for one in findings):
            return findings
        for task in tasks:
            policy = Path(private) / entry.policy.name
            for finding in _task(entry, policy, task, protocol, games, seed, limits or Limits()):
                add(finding)
    return findings


def _protocol(entry: Entry, protocol: Protocol) -> Finding:
    same = entry.protocol == protocol.hash
    return Finding("protocol", same, entry.protocol if same else f"{entry.protocol}, here is {protocol.hash}")


def _game() -> Finding:
    found = departures()
    return Finding("game", not found, found[0] if found else "this version plays the protocol's")


def _files(entry: Entry, private: Path) -> Iterator[Finding]:
    """Copy the files as they are now, so that those which are played are those which were looked at."""
    for name, expected in entry.files.items():
        try:
            content = read_policy_file(entry.folder / name)
        except (OSError, ValueError) as error:
            reason = error.strerror if isinstance(error, OSError) else error
            yield Finding(name, False, f"cannot be read: {reason}")
            continue
        same = digest(content) == expected
        (private / name).write_bytes(content)
        yield Finding(name, same, "as it was entered" if same else "is not the file that was entered")
    for name in sorted(files_of(entry.name, entry.folder) - set(entry.files)):
        yield Finding(name, False, "is not listed in the entry")


def _task(
    entry: Entry, policy: Path, task: Task, protocol: Protocol, games: int, seed: int, limits: Limits
) -> Iterator[Finding]:
    try:
        played = {row.opponent: row for row in play_in_sandbox(policy, task, protocol, games, seed, limits)}
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
    """The entry's file of a path, with or without its ending, or of an entry's name in `leaderboard/` here."""
    file = name if name.suffix == ".toml" else name.with_name(f"{name.name}.toml")
    in_leaderboard = LEADERBOARD / file
    return in_leaderboard if len(file.parts) == 1 and not file.exists() and in_leaderboard.exists() else file
