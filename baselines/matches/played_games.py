"""Matches that were played one by one, a person's say, as lines of a file; and what ratings take of them."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path

from baselines.matches.payoff import Results
from puckpilot_env.files import small_file

KEYS = ("recording", "players", "score", "ending", "seed", "ended")


def add_game(
    file: Path, players: tuple[str, str], score: Sequence[int], *, recording: str, ending: str, seed: int, ended: str
) -> None:
    """Append a match that was played to its end: `score`, the goals of each; `ended`: when, in ISO 8601."""
    values = (recording, list(players), list(score), ending, seed, ended)
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(dict(zip(KEYS, values, strict=True))) + "\n")


def read_pairs(file: Path) -> Results:
    """The results of all matches, each two in a row of the same players as a pair; the last one of an odd number is
    left out. ValueError, in one line, for a file that is none; OSError if it cannot be read."""
    found: dict[tuple[str, str], list[int]] = {}
    for number, line in enumerate(small_file.read_text(file).splitlines(), 1):
        try:
            (first, second), (goals, conceded) = (json.loads(line)[key] for key in ("players", "score"))
            result = (int(goals) > int(conceded)) - (int(goals) < int(conceded))
        except (ValueError, KeyError, TypeError):
            raise ValueError(
                f"{file}, line {number}: not a match; expected lines as puckpilot arena writes them"
            ) from None
        if (str(second), str(first)) in found:
            first, second, result = second, first, -result
        found.setdefault((str(first), str(second)), []).append(result)
    return {
        players: [results[k : k + 2] for k in range(0, len(results) - 1, 2)]
        for players, results in found.items()
        if len(results) > 1
    }
