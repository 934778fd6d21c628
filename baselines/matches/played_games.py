"""Matches that were played one by one, a person's say, as lines of a file; and what ratings take of them."""

from __future__ import annotations

import json
from collections.abc import Iterable, Sequence
from pathlib import Path

from baselines.matches.payoff import Results
from puckpilot_env.files import small_file

Game = tuple[tuple[str, str], tuple[int, int]]
"""Who played, by seat, and the goals of each."""
MOST_BYTES = 1 << 26  # of a file: hundreds of thousands of matches
KEYS = ("recording", "players", "score", "ending", "seed", "ended")


def add_game(
    file: Path, players: tuple[str, str], score: Sequence[int], *, recording: str, ending: str, seed: int, ended: str
) -> None:
    """Append a match that was played to its end: `score`, the goals of each; `ended`: when, in ISO 8601."""
    values = (recording, list(players), list(score), ending, seed, ended)
    with file.open("a", encoding="utf-8") as lines:
        lines.write(json.dumps(dict(zip(KEYS, values, strict=True))) + "\n")


def read_games(file: Path) -> list[Game]:
    """All matches, in the order of the file. ValueError, in one line, for a file that is none; OSError if it cannot be
    read."""
    games = []
    for number, line in enumerate(small_file.read_text(file, MOST_BYTES).splitlines(), 1):
        try:
            (first, second), (goals, conceded) = (json.loads(line)[key] for key in ("players", "score"))
            games.append(((str(first), str(second)), (int(goals), int(conceded))))
        except (ValueError, KeyError, TypeError):
            raise ValueError(
                f"{file}, line {number}: not a match; expected lines as puckpilot arena writes them"
            ) from None
    return games


def pairs_of(games: Iterable[Game]) -> Results:
    """The results of matches, each two in a row of the same players as a pair; the last one of an odd number is left
    out."""
    found: dict[tuple[str, str], list[int]] = {}
    for (first, second), (goals, conceded) in games:
        result = (goals > conceded) - (goals < conceded)
        if (second, first) in found:
            first, second, result = second, first, -result
        found.setdefault((first, second), []).append(result)
    return {
        players: [results[k : k + 2] for k in range(0, len(results) - 1, 2)]
        for players, results in found.items()
        if len(results) > 1
    }


def read_pairs(file: Path) -> Results:
    """`pairs_of` the matches of a file; see `read_games`."""
    return pairs_of(read_games(file))
