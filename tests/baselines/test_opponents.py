"""Who may play the other seat of an environment: names, the caller's own classes, and another at each table."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from baselines import find_player, full_name, make_player
from baselines.commands import match
from baselines.gymnasium_seat import make_seats
from baselines.opponents import find_opponent
from baselines.player import Player, Seat
from puckpilot_env.batch.motion import mallet_motion
from puckpilot_env.tables import Tables
from tests.baselines.test_commands import call

OWN = '''
import numpy as np
from baselines.player import Player

class Corner(Player):
    """Stays in a corner."""

    def decide(self, state):
        return self.action(0.1, 0.1)

class Nobody:
    def __init__(self, seat):
        pass

number = 3
'''


@pytest.fixture
def own(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> str:
    """A module of a caller's own, in the folder where commands are called."""
    (tmp_path / "own_players.py").write_text(OWN)
    monkeypatch.chdir(tmp_path)
    return "own_players"


def test_several_opponents_are_dealt_to_the_tables_in_turn() -> None:
    names, tables = ["goalie", "random", "policy:champion"], Tables("match-v0", 7, seed=2)
    several = find_opponent(names, tables, seed=4)
    alone = [
        make_player(name, Seat.from_tables(Tables("match-v0", len(range(k, 7, 3))), seed=4))
        for k, name in enumerate(names)
    ]
    for step in range(3):
        seen = np.roll(tables.observations[:, 1], step, axis=0)
        found = several.act(seen)
        for k, player in enumerate(alone):
            np.testing.assert_array_equal(found[k::3], player.act(seen[k::3]))


def test_tables_of_several_opponents_play_as_those_of_one_do() -> None:
    """Scripts without randomness of their own: each table's game is that of an environment of its opponent alone."""
    names = ["interceptor", "follower"]
    games = [make_seats("puckpilot/match-v0", 6, opponent=one) for one in (names, *names)]
    for envs in games:
        envs.reset(seed=8)
    low, high = games[0].tables.action_bounds
    for step in range(60):
        action = np.tile(low + (0.5 + 0.4 * np.sin(step)) * (high - low), (6, 1)).astype(np.float32)
        mixed, first, second = (envs.step(action)[0] for envs in games)
        np.testing.assert_array_equal(mixed[0::2], first[0::2])
        np.testing.assert_array_equal(mixed[1::2], second[1::2])
    assert not np.array_equal(first, second)


def test_seeds_begin_the_randomness_of_several_anew() -> None:
    envs = make_seats("puckpilot/match-v0", 4, opponent=["random", "random"])
    action = np.tile(envs.tables.action_bounds.mean(axis=0), (4, 1)).astype(np.float32)

    def game(seed: int) -> bytes:
        envs.reset(seed=seed)
        return b"".join(envs.step(action)[0].tobytes() for _ in range(20))

    assert game(1) == game(1) != game(2)


@pytest.mark.parametrize(
    ("opponent", "words"),
    [
        ([], "names 0 players; expected 1 to 2, one a table"),
        (["goalie"] * 3, "names 3 players"),
        (["goalie", "golie"], "did you mean 'goalie'"),
        (["goalie", 3], "opponent is 3; expected a player's name"),
        (3, "opponent is 3; expected a player's name"),
    ],
)
def test_what_cannot_play_is_refused_in_one_line(opponent: object, words: str) -> None:
    with pytest.raises(ValueError, match=words) as error:
        make_seats("puckpilot/match-v0", 2, opponent=opponent)  # pyright: ignore[reportArgumentType]
    assert "\n" not in str(error.value)


def test_a_class_of_the_caller_s_own_plays_by_its_name(own: str, capsys: pytest.CaptureFixture[str]) -> None:
    name = f"{own}:Corner"
    assert full_name(name) == name
    envs = make_seats("puckpilot/match-v0", 1, opponent=name)
    envs.reset(seed=0)
    for _ in range(30):
        envs.step(np.array([[0.3, 0.5, 5.0, 5.0]], np.float32))
    p, place = envs.tables.params[0], mallet_motion(envs.tables.states[0])[1, :2]
    np.testing.assert_allclose(place, [p["length"] - 0.1, p["width"] - 0.1], atol=1e-3)
    assert call(match, name, "interceptor", "--games", "3") == 0
    assert f"{name} won 0 of " in capsys.readouterr().out


@pytest.mark.parametrize(
    ("attribute", "words"),
    [
        ("Missing", "cannot import 'own_players:Missing': AttributeError"),
        ("Nobody", "'own_players:Nobody' makes a Nobody; expected a Player, with reset and act"),
        ("number", "'own_players:number' is a int; expected something that makes a Player for a Seat"),
    ],
)
def test_what_is_no_player_is_refused_in_one_line(own: str, attribute: str, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        make_player(f"{own}:{attribute}", Seat.from_tables(Tables("match-v0", 1)))


def test_a_policy_s_name_is_no_module(own: str) -> None:
    assert issubclass(type(make_player("policy:champion", Seat.from_tables(Tables("match-v0", 1)))), Player)
    with pytest.raises(ValueError, match="cannot import 'no_such_module:Player'"):
        find_player("no_such_module:Player")
