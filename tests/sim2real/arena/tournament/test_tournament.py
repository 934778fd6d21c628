"""Several players meet in turn: who meets next, what came of it, and that the next match begins by itself."""

from __future__ import annotations

import asyncio
import json
from collections import Counter
from itertools import permutations
from pathlib import Path
from typing import Any

import pytest

aiohttp = pytest.importorskip("aiohttp", reason="it comes with pip install '.[test]'")
from aiohttp.test_utils import TestClient, TestServer  # noqa: E402

from baselines.matches.played_games import Game, pairs_of, read_games  # noqa: E402
from baselines.ratings.rating import fit_ratings_from_pairs  # noqa: E402
from sim2real.arena.lobby import Lobby  # noqa: E402
from sim2real.arena.recordings import records as records_module  # noqa: E402
from sim2real.arena.recordings.records import GAMES, Records  # noqa: E402
from sim2real.arena.server import make_app  # noqa: E402
from sim2real.arena.tournament import tour as tour_module  # noqa: E402
from sim2real.arena.tournament.schedule import next_match  # noqa: E402
from sim2real.arena.tournament.standings import among, standings  # noqa: E402
from sim2real.arena.tournament.tour import Tour  # noqa: E402

PLAYERS = ["still", "goalie", "follower"]


def test_all_meet_from_both_seats_with_the_same_seed_before_any_meet_again() -> None:
    games: list[Game] = []
    seeds: dict[tuple[int, frozenset[str]], set[int]] = {}
    for number in range(12):
        names, seed = next_match(PLAYERS, games, 40)
        games.append((names, (0, 0)))
        seeds.setdefault((number // 6, frozenset(names)), set()).add(seed)
    for part in (games[:6], games[6:]):
        assert Counter(names for names, _ in part) == Counter(permutations(PLAYERS, 2))
    assert all(len(found) == 1 for found in seeds.values())  # in a round, a pair has one seed
    assert {min(found) for (turn, _), found in seeds.items() if turn == 0}.isdisjoint(
        min(found) for (turn, _), found in seeds.items() if turn == 1
    )


def test_a_match_that_was_broken_off_is_played_before_others() -> None:
    assert next_match(PLAYERS, [(("still", "goalie"), (1, 0))], 0)[0] == ("goalie", "still")


def test_standings_count_matches_by_hand_and_rate_as_the_tournament_does() -> None:
    games: list[Game] = [
        (("still", "goalie"), (0, 7)), (("goalie", "still"), (7, 1)), (("human:ann", "goalie"), (3, 1)),
        (("still", "follower"), (2, 2)), (("follower", "still"), (4, 0)), (("follower", "goalie"), (1, 5)),
    ]  # fmt: skip
    met = among(PLAYERS, games)
    assert len(met) == 5
    found = {row.name: row for row in standings(PLAYERS, met)}
    counts = {name: (row.matches, row.won, row.drawn, row.lost) for name, row in found.items()}
    assert counts == {"still": (4, 0, 1, 3), "goalie": (3, 3, 0, 0), "follower": (3, 1, 1, 1)}
    rated = fit_ratings_from_pairs({("still", "goalie"): [[-1, -1]], ("still", "follower"): [[0, -1]]})
    assert {name: found[name].rating for name in rated.players} == dict(zip(rated.players, rated.elo, strict=True))
    assert [row.name for row in standings(PLAYERS, met)] == ["goalie", "follower", "still"]


def test_players_that_never_met_have_no_ratings_yet() -> None:
    players = ["a", "b", "c", "d"]
    games: list[Game] = [(("a", "b"), (1, 0)), (("b", "a"), (1, 0)), (("c", "d"), (1, 0)), (("d", "c"), (1, 0))]
    assert [row.rating for row in standings(players, games)] == [None] * 4 and pairs_of(games)
    assert [row.matches for row in standings(players, [])] == [0] * 4


async def heard(line: Any, kind: str) -> dict[str, Any]:
    while True:
        message = json.loads((await line.receive(timeout=60.0)).data)
        if message["kind"] == kind:
            return message


@pytest.mark.slow
@pytest.mark.parametrize("room", [1e9, -1.0])
def test_the_next_match_begins_by_itself_and_all_see_the_standings(
    room: float, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """With room for recordings, and without."""
    monkeypatch.setattr(tour_module, "PAUSE", 0.2)
    monkeypatch.setattr(records_module, "MOST", room)
    games: list[Game] = []

    async def run() -> None:
        records = Records(tmp_path)
        lobby = Lobby(("still", "goalie"), 0, records, lambda _, lateness: Tour(PLAYERS, games, 0, records, lateness))
        async with TestClient(TestServer(make_app(lobby, records, "a-token"))) as client:
            origin = str(client.make_url("/")).rstrip("/")
            headers = {"Origin": origin}
            with pytest.raises(aiohttp.WSServerHandshakeError, match="403"):
                await client.ws_connect("/game", params={"token": "b"}, headers=headers)
            line = await client.ws_connect("/game", params={"token": "a-token"}, headers=headers)
            met = []
            for _ in range(2):
                welcome = await heard(line, "welcome")
                assert welcome["seat"] is None and welcome["again"] is False
                met.append(tuple(welcome["names"]))
                (session,) = lobby._sessions.values()
                if not games:
                    first = await heard(line, "standings")
                    assert [row["matches"] for row in first["rows"]] == [0, 0, 0]
                    await line.send_str('{"kind":"again"}')  # which nobody may ask for
                session.game.tables.states["steps"] = 180 * 120 - 20  # of a match of three minutes
                after = await heard(line, "standings")
                assert {row["name"]: row["matches"] for row in after["rows"]}[met[-1][0]] == len(met)
            assert met == [("still", "goalie"), ("goalie", "still")] and after["next"] == ["still", "follower"]

    asyncio.run(asyncio.wait_for(run(), 120.0))
    assert [names for names, _ in read_games(tmp_path / GAMES)] == [("still", "goalie"), ("goalie", "still")] and (
        games == read_games(tmp_path / GAMES)
    )
