"""Scripted players: found by their files, inside the action bounds, deterministic, and as strong as they claim."""

from __future__ import annotations

from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

import baselines.players
from baselines import Seat, make_player, player_names
from baselines.matches.match import play
from puckpilot_env.tables import Tables
from puckpilot_env.variants import all_variants

MATCH, DEFENCE = "match-v0", "defence-v0"
WIDE = {"width": 1.4, "length": 2.6, "goal_width": 0.4, "mallet_radius": 0.06}


def _play_along(name: str, tables: Tables, steps: int) -> NDArray[np.float32]:
    """The player's actions (steps, n, 4) at seat 0 against random ones at seat 1; checks the bounds on the way."""
    player = make_player(name, Seat.from_tables(tables, seed=4))
    player.reset(np.ones(len(tables), np.bool_))
    draws = np.random.default_rng(8)
    low, high = tables.action_bounds
    played = np.zeros((steps, len(tables), 4), np.float32)
    for step in range(steps):
        played[step] = player.act(tables.observations[:, 0])
        other = draws.uniform(low, high, (len(tables), 4)).astype(np.float32)
        tables.step(np.stack([played[step], other], axis=1))
        player.reset(tables.terminated | tables.truncated)
    assert (played >= low).all() and (played <= high).all()
    return played


@pytest.mark.slow
@pytest.mark.parametrize("variant", list(all_variants()))
@pytest.mark.parametrize("name", player_names())
def test_actions_stay_inside_the_bounds_on_every_variant(name: str, variant: str) -> None:
    _play_along(name, Tables(variant, 3, seed=1), 50)


@pytest.mark.parametrize("variant", list(all_variants()))
def test_decoded_states_have_one_memory_layout(variant: str) -> None:
    """Kernels compile anew for each, and the veteran's search takes minutes."""
    tables = Tables(variant, 3, seed=1)
    state = make_player("still", Seat.from_tables(tables)).decoder.decode(tables.observations[:, 0])
    assert all(getattr(state, field.name).flags.c_contiguous for field in fields(state))


@pytest.mark.parametrize("name", player_names())
def test_players_take_the_tables_size_from_their_seat(name: str) -> None:
    _play_along(name, Tables(MATCH, 3, seed=2, parameters=WIDE), 50)


@pytest.mark.parametrize("name", player_names())
def test_the_same_seed_gives_the_same_actions(name: str) -> None:
    first, second = (_play_along(name, Tables(MATCH, 3, seed=5), 30) for _ in range(2))
    np.testing.assert_array_equal(first, second)


@pytest.mark.slow
@pytest.mark.parametrize("name", [n for n in player_names() if n != "random"])
def test_actions_at_a_table_do_not_depend_on_other_tables(name: str) -> None:
    tables = Tables(MATCH, 4, seed=6)
    observation = tables.observations[:, 1].copy()
    together = make_player(name, Seat.from_tables(tables)).act(observation)
    alone = make_player(name, Seat.from_tables(Tables(MATCH, 1))).act(observation[2:3])
    np.testing.assert_array_equal(together[2:3], alone)


def test_names_are_sorted_and_a_new_file_is_a_player(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    names = player_names()
    assert names == sorted(names)
    assert {"still", "random", "goalie", "follower", "interceptor", "bank_shot", "veteran"} <= set(names)
    (tmp_path / "newcomer.py").write_text(
        "from baselines.player import Player\n\n\n"
        "class Newcomer(Player):\n"
        "    def decide(self, state):\n"
        "        return self.action(0.3, 0.4)\n"
    )
    monkeypatch.setattr(baselines.players, "__path__", [*baselines.players.__path__, str(tmp_path)])
    assert player_names() == sorted([*names, "newcomer"])
    tables = Tables(MATCH, 2)
    action = make_player("newcomer", Seat.from_tables(tables)).act(tables.observations[:, 0])
    np.testing.assert_allclose(action, [[0.3, 0.4, 10.0, 10.0]] * 2, rtol=1e-6)


def test_an_unknown_name_is_refused_in_one_line_with_a_suggestion() -> None:
    seat = Seat.from_tables(Tables(MATCH, 1))
    with pytest.raises(ValueError, match="did you mean 'goalie'") as raised:
        make_player("golie", seat)
    assert "\n" not in str(raised.value)


def _conceded(name: str) -> int:
    """Goals against player 0 in as many shots at it; all of them would be goals or near misses."""
    return play(DEFENCE, name, "still", 400, seed=3).goals[1]


def test_a_mallet_that_stands_still_concedes_and_a_goalie_hardly_does() -> None:
    assert _conceded("still") > 50
    assert _conceded("goalie") <= 2


@pytest.mark.parametrize("name", ["interceptor", "veteran"])
def test_players_that_predict_keep_their_goal(name: str) -> None:
    assert _conceded(name) <= 2


@pytest.mark.parametrize("other", ["still", "random", "follower", "interceptor"])
def test_the_veteran_beats_the_others(other: str) -> None:
    result = play(MATCH, "veteran", other, 6, seed=1)
    assert result.wins[0] >= 5
    assert result.wins[1] == 0
    assert result.goals[0] > 3 * result.goals[1]
