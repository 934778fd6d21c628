"""The leaderboard's page: all entries of its folder, ranked in each task by the mean of their scores."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from agents.benchmark.entry import Claim, Entry, read_entry
from agents.benchmark.evaluation import Against, mean_score
from agents.benchmark.protocol import Protocol, Task
from puckpilot_env.files.whole_file import write_text_whole

PAGE = "README.md"


def write_page(folder: Path, protocol: Protocol) -> Path:
    """Write the page of a leaderboard's folder; its path. ValueError, in one line, for an entry that is none."""
    return write_text_whole(folder / PAGE, page_of(read_entries(folder), protocol))


def read_entries(folder: Path) -> list[Entry]:
    """All entries of a folder, by name. ValueError, in one line, for one that is none."""
    return [read_entry(file) for file in sorted(folder.glob("*.toml"))]


def page_of(entries: Sequence[Entry], protocol: Protocol) -> str:
    """The page, in Markdown: a table for each task of which something is claimed."""
    lines = [
        "# Leaderboard",
        "",
        f"Players by protocol {protocol.version} (`{protocol.hash}`): scores in per cent of points in a match, of jobs "
        "done in a drill, as their entries claim. `puckpilot benchmark verify leaderboard/NAME` plays anew what one "
        "claims; `puckpilot benchmark enter` makes an entry, and this page.",
        "",
    ]
    for task in protocol.tasks.values():
        opponents = protocol.evaluated_against(task)
        if ranked := _ranked([one for one in entries if one.protocol == protocol.hash], task, opponents):
            lines += [
                f"## {task.name}", "",
                f"| | mean | {' | '.join(opponents)} |",
                "| --- " * (2 + len(opponents)) + "|",
                *(f"| {name} | {' | '.join(f'{100 * one:.1f}' for one in scores)} |" for name, scores in ranked), "",
            ]  # fmt: skip
    lines += ["## How they were trained", "", *(f"- **{one.name}**: {one.trained}" for one in entries)]
    return "\n".join(lines) + "\n"


def _ranked(entries: Sequence[Entry], task: Task, opponents: Sequence[str]) -> list[tuple[str, list[float]]]:
    """Name, and the mean score followed by that against each opponent, of each entry that has claims of the task."""
    rows = []
    for entry in entries:
        against = {claim.opponent: _against(claim, task) for claim in entry.claims_of(task.name)}
        if against:
            each = [against[name].score for name in opponents]
            rows.append((entry.name, [mean_score(against.values()), *each]))
    return sorted(rows, key=lambda row: -row[1][0])


def _against(claim: Claim, task: Task) -> Against:
    return Against(claim.opponent, claim.games, claim.won, claim.lost, (0, 0), task.is_match)
