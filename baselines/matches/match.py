"""Two players against each other in paired games: every table is played twice, with the seats exchanged."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baselines import make_player
from baselines.player import Player, Seat
from baselines.ratings.intervals import paired_win_rate
from puckpilot_env.options.draws_file import Draws
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import whole_number
from puckpilot_env.tables import Tables
from puckpilot_env.variants import Variant

Contestant = str | Callable[[Seat], Player]  # a player's name, or a function that makes a player for a seat
MOST_GAMES = 1_000_000
Progress = Callable[[int, int], None]
"""Called with the number of games done and of all games."""
Watch = Callable[[Tables, NDArray[np.float32]], None]
"""Called before each step with the tables and the actions (n, 2, 4) about to be played."""


@dataclass(frozen=True)
class MatchResult:
    """The result of a match between a first and a second player; pairs of numbers are in this order.

    - `games`: number of games; `wins`, `draws`, `goals`: counts; `fouls`: how often each held the puck for too long.
    - `results` (pairs, 2): 1, 0, -1 as the first player won, drew, lost in seat 0 and in seat 1; NaN if not played.
    - `lengths` (games,): steps of each game, those with the first player in seat 0 first.
    - `endings` (games,): how each ended, a number of `rules.ENDING_NAMES`, in the same order.
    """

    players: tuple[str, str]
    games: int
    wins: tuple[int, int]
    draws: int
    goals: tuple[int, int]
    results: NDArray[np.float64]
    lengths: NDArray[np.int64]
    endings: NDArray[np.int64]
    fouls: tuple[int, int] = (0, 0)

    @property
    def fouls_per_game(self) -> tuple[float, float]:
        """Mean fouls of each player in a game."""
        return self.fouls[0] / self.games, self.fouls[1] / self.games

    @property
    def padded_results(self) -> NDArray[np.float64]:
        """`results` with games that were not played as draws; neither counts in the share of decisive games."""
        return np.nan_to_num(self.results)

    def counts(self) -> dict[str, Any]:
        """Wins, draws, goals, fouls and the share of decisive games, as JSON can hold them.

        Not for drills, where these would add up the results of two different jobs.
        """
        return {
            "wins": list(self.wins), "draws": self.draws, "goals": list(self.goals), "fouls": list(self.fouls),
            "decisive_win_rate": paired_win_rate(self.padded_results).as_dict(),
        }  # fmt: skip

    @property
    def decisive_share(self) -> float:
        """Share of the decisive games that the first player won; NaN where there were none."""
        decisive = sum(self.wins)
        return self.wins[0] / decisive if decisive else float("nan")


@dataclass(frozen=True)
class _Half:
    """The games played in one order of the seats, one on each of n tables."""

    winners: NDArray[np.int64]  # (n,) seat, or -1
    scores: NDArray[np.int64]  # (n, 2)
    fouls: NDArray[np.int64]  # (n, 2)
    lengths: NDArray[np.int64]  # (n,)
    endings: NDArray[np.int64]  # (n,)


def play(
    variant: Variant | str,
    first: Contestant,
    second: Contestant,
    games: int,
    seed: int,
    *,
    parameters: Mapping[str, float] | None = None,
    effects: Effects | None = None,
    draws: Draws | None = None,
    progress: Progress | None = None,
    threads: int = 1,
    watch: Watch | None = None,
    exchange: bool = True,
) -> MatchResult:
    """Play `games` episodes of `variant` (or its id), half of them with the seats exchanged, or none if not `exchange`.

    Pair i uses random stream i of `seed` in both halves; of an odd number, the last pair is half. `parameters`,
    `effects`, `draws` and `threads` are those of `Tables`. `watch` is called at every step of the games with `first` in
    seat 0. The same call gives the same result. ValueError, in one line, for an invalid argument.
    """
    games = whole_number(games, "games", 1, MOST_GAMES)
    halves = []
    done = 0
    exchanged = games // 2 if exchange else 0
    for seats, count in (((first, second), games - exchanged), ((second, first), exchanged)):
        if count == 0:
            break
        tables = Tables(
            variant,
            count,
            seed=seed,
            threads=threads,
            autoreset=False,
            parameters=parameters,
            effects=effects,
            draws=draws,
        )
        tick = (lambda ended, before=done: progress(before + ended, games)) if progress else None
        halves.append(_play_half(tables, seats, seed, tick, None if halves else watch))
        tables.close()
        done += count
    return _add_up((_name(first), _name(second)), games, halves)


def _play_half(
    tables: Tables,
    seats: tuple[Contestant, Contestant],
    seed: int,
    tick: Callable[[int], None] | None,
    watch: Watch | None,
) -> _Half:
    """Play one episode on every table. A table whose episode has ended is stepped on, but no longer recorded."""
    count = len(tables)
    players = [_make(contestant, Seat.from_tables(tables, seed=2 * seed + k)) for k, contestant in enumerate(seats)]
    for player in players:
        player.reset(np.ones(count, np.bool_))
    half = _Half(np.full(count, -1), *np.zeros((2, count, 2), np.int64), *np.zeros((2, count), np.int64))
    running = np.ones(count, np.bool_)
    actions = np.zeros((count, 2, 4), np.float32)
    while running.any():
        for k, player in enumerate(players):
            actions[:, k] = player.act(tables.observations[:, k])
        if watch:
            watch(tables, actions)
        tables.step(actions)
        half.lengths[running] += 1
        ended = running & (tables.terminated | tables.truncated)
        half.winners[ended] = tables.states["winner"][ended]
        half.scores[ended] = tables.states["score"][ended]
        half.fouls[ended] = tables.states["fouls"][ended]
        half.endings[ended] = tables.states["ending"][ended]
        running &= ~ended
        if tick and ended.any():
            tick(int(count - running.sum()))
    return half


def _add_up(names: tuple[str, str], games: int, halves: list[_Half]) -> MatchResult:
    results = np.full((len(halves[0].winners), 2), np.nan)
    goals, fouls = np.zeros((2, 2), np.int64)
    for seat, half in enumerate(halves):  # of the first player
        results[: len(half.winners), seat] = np.where(half.winners < 0, 0.0, np.where(half.winners == seat, 1.0, -1.0))
        goals += np.roll(half.scores.sum(axis=0), seat)
        fouls += np.roll(half.fouls.sum(axis=0), seat)
    wins = (int((results == 1.0).sum()), int((results == -1.0).sum()))
    return MatchResult(
        names,
        games,
        wins,
        games - sum(wins),
        (int(goals[0]), int(goals[1])),
        results,
        np.concatenate([half.lengths for half in halves]),
        np.concatenate([half.endings for half in halves]),
        (int(fouls[0]), int(fouls[1])),
    )


def _make(contestant: Contestant, seat: Seat) -> Player:
    return make_player(contestant, seat) if isinstance(contestant, str) else contestant(seat)


def _name(contestant: Contestant) -> str:
    return contestant if isinstance(contestant, str) else getattr(contestant, "__name__", type(contestant).__name__)
