"""A match of the arena: what a player does there is what it does in the variant, and a person's mallet goes where it
is pointed at."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.tables import Tables
from sim2real.arena.game import PERSON, TICKS, Game
from sim2real.arena.seats import PersonChair


def test_twelve_ticks_of_held_decisions_are_a_step_of_the_variant() -> None:
    """Against the variant's own step of 0.1 s, until the puck is touched first; each tick plans anew."""
    game = Game(("interceptor", "goalie"), 7)
    tables = Tables("match-v0", 1, seed=7, autoreset=False)
    for _ in range(6):
        held = np.stack([chair.action(game.tables.observations[0, k], 0) for k, chair in enumerate(game.chairs)])
        tables.step(held[None])
        for _ in range(12):
            game.tick()
        np.testing.assert_allclose(mallet_motion(game.tables.states), mallet_motion(tables.states), atol=2e-4)
        np.testing.assert_allclose(puck_motion(game.tables.states), puck_motion(tables.states), atol=2e-3)
    assert game.view().time == pytest.approx(0.6)


@pytest.mark.parametrize("seat", [0, 1])
def test_a_persons_mallet_comes_to_the_pointer_and_stays_in_its_half(seat: int) -> None:
    game = Game((PERSON, "still") if seat == 0 else ("still", PERSON), 1)
    person = game.chairs[seat]
    assert isinstance(person, PersonChair) and game.person is person
    length = float(game.tables.params["length"][0])
    x = 0.3 if seat == 0 else length - 0.3
    person.aim(x, 0.25)
    for _ in range(TICKS):
        game.tick()
    assert game.view().mallets[seat] == pytest.approx((x, 0.25), abs=2e-3)
    person.aim(length - x, 0.75)  # in the other's half
    for _ in range(TICKS):
        game.tick()
    there, y = game.view().mallets[seat] or (math.nan, math.nan)
    assert y == pytest.approx(0.75, abs=2e-3) and (there < 0.5 * length) == (seat == 0)


@pytest.mark.parametrize("seat", [0, 1])
def test_a_quick_mallet_goes_four_times_as_far_in_the_same_time(seat: int) -> None:
    """The gantry's law is linear in the volts, and in one over its coefficients."""
    names = (PERSON, "still") if seat == 0 else ("still", PERSON)
    gone = []
    for game in (Game(names, 1), Game(names, 1, quick=True)):
        before = mallet_motion(game.tables.states)[0, :, :2]
        assert game.person is not None and game.is_rated == (len(gone) == 0)
        game.person.aim(0.5, before[seat, 1] + 0.4)
        for _ in range(6):
            game.tick()
        after = mallet_motion(game.tables.states)[0, :, :2]
        np.testing.assert_allclose(after[1 - seat], before[1 - seat], atol=1e-6)
        gone.append(after[seat, 1] - before[seat, 1])
    assert gone[1] == pytest.approx(4.0 * gone[0], rel=1e-3) and gone[0] > 0.01


def test_a_goal_is_counted_and_the_match_ends_once() -> None:
    """The champion scores against one who does not move."""
    game = Game((PERSON, "policy:champion"), 3)
    for _ in range(200 * TICKS):
        game.tick()
    view = game.view()
    assert game.over and view.score[1] == 7 > view.score[0] and view.ending == "points"
    ticks = game.ticks
    game.tick()
    assert game.ticks == ticks


def test_an_unknown_player_is_refused() -> None:
    with pytest.raises(ValueError, match="unknown player 'goaly'"):
        Game((PERSON, "goaly"), 0)


def test_a_mallet_that_was_placed_a_little_off_is_noticed_and_no_other() -> None:
    """After a goal or a foul mallets stand at home, which may be near to where they were."""
    game = Game((PERSON, "still"), 3)
    assert game.person is not None
    for tick in range(240):
        game.person.aim(0.4 + 0.001 * tick, 0.5, tick)
        game.tick()
    assert game.person.followed()["placed"] == 0
    game.tables.states[0]["mallets"][0]["x"]["rest"] += 0.02
    game.tick()
    assert game.person.followed()["placed"] == 1
    game.tick()
    assert game.person.followed()["placed"] == 1
