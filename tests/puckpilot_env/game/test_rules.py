"""How the three games go on and end: points, clocks, face-offs, serves, drills, truncation, and who won."""

from __future__ import annotations

import numpy as np
import pytest

from baselines.matches.match import play
from puckpilot_env import Tables, find_variant
from puckpilot_env.adapters.infos import outcome_info
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.batch.motion import mallet_motion, puck_motion
from puckpilot_env.game import rules
from tests.puckpilot_env.game.hand import FRICTIONLESS, STAYING_COST, put_mallet, put_puck, staying, touch

DRILLS = ["defence-v0", "attack-v0"]


def make(variant: str, tables: int = 1, **options) -> Tables:
    return Tables(variant, tables, **{"autoreset": False, "parameters": FRICTIONLESS, **options})


def stay(tables: Tables) -> None:
    tables.step(staying(tables))


def park(tables: Tables) -> None:
    """The puck at rest, both mallets out of its way."""
    put_puck(tables, 0.6, 0.3)
    for player in range(2):
        put_mallet(tables, player, 0.2, 0.7)


def shoot_in(tables: Tables, scorer: int) -> None:
    """One step in which the puck enters the goal of `scorer`'s opponent."""
    park(tables)
    put_puck(tables, 0.1, 0.5, -3.0, 0.0, 1 - scorer)
    stay(tables)


def outcome(tables: Tables) -> tuple[str, int]:
    state = tables.states[0]
    assert (tables.terminated[0] or tables.truncated[0]) == (state["ending"] != rules.RUNNING)
    return rules.ENDING_NAMES[state["ending"]], int(state["winner"])


@pytest.mark.parametrize("winner", [0, 1])
def test_first_to_seven(winner):
    tables = make("match-v0")
    tables.states["score"][0, 1 - winner] = 6
    for points in range(1, 8):
        shoot_in(tables, winner)
        assert tables.states["score"][0, winner] == points
        assert bool(tables.terminated[0]) == (points == 7)
    assert outcome(tables) == ("points", winner) and not tables.truncated[0]
    tables.reset()
    assert tables.states["score"][0].tolist() == [0, 0]
    assert tables.states["last_score"][0].tolist() == ([7, 6] if winner == 0 else [6, 7])


def test_score_and_winner_outlast_an_automatic_reset():
    tables = make("match-v0", autoreset=True)
    tables.states["score"] = (2, 6)
    shoot_in(tables, 1)
    state = tables.states[0]
    assert tables.terminated[0] and state["winner"] == 1
    assert state["score"].tolist() == [0, 0] and state["last_score"].tolist() == [2, 7]
    assert state["time"] == state["steps"] == 0 and state["episode"] == 2


@pytest.mark.parametrize("conceder", [0, 1])
def test_the_conceder_serves(conceder):
    """The puck at rest before the conceder, both at home, the clock going on."""
    tables = make("match-v0", 300, autoreset=True)
    tables.states["steps"] = 99
    shoot_in(tables, 1 - conceder)
    puck = puck_motion(tables.states)
    assert (puck[:, 2:] == 0).all()
    np.testing.assert_allclose(puck[:, 0], [0.6, 1.4][conceder])
    assert puck[:, 1].min() >= 0.25 and puck[:, 1].max() <= 0.75 and np.ptp(puck[:, 1]) > 0.45
    np.testing.assert_allclose(
        mallet_motion(tables.states), np.tile([[0.25, 0.5, 0, 0], [1.75, 0.5, 0, 0]], (300, 1, 1))
    )
    np.testing.assert_allclose(tables.states["time"], 10.0)
    assert (tables.states["held"] == 0).all() and (tables.states["defending"] == 1).all()


@pytest.mark.parametrize("score, winner", [((3, 2), 0), ((0, 1), 1), ((4, 4), -1)])
def test_the_clock(score, winner):
    """180 s; the leader wins, level is a draw."""
    tables = make("match-v0")
    tables.states["score"] = score
    tables.states["steps"] = 1798
    park(tables)
    stay(tables)
    assert not tables.terminated[0]
    stay(tables)
    assert outcome(tables) == ("clock", winner) and not tables.truncated[0]
    assert tables.states["time"][0] == pytest.approx(180.0)


def test_a_goal_in_the_last_step_counts():
    tables = make("match-v0")
    tables.states["steps"] = 1799
    tables.states["score"] = (2, 2)
    shoot_in(tables, 1)
    assert outcome(tables) == ("clock", 1) and tables.states["score"][0].tolist() == [2, 3]


@pytest.mark.parametrize("period, steps", [(0.1, 70), (0.05, 140), (1 / 120, 840), (0.3, 24)])
@pytest.mark.parametrize("player", [0, 1])
def test_holding_the_puck_for_seven_seconds_is_a_foul(player, period, steps):
    """It costs a point's worth and the puck, which the opponent serves."""
    tables = make("match-v0", period=period)
    park(tables)
    put_puck(tables, 0.6, 0.3, player=player)
    tables.states["held"] = 0.0
    tables.states["defending"] = (0, 1)
    for _ in range(steps - 1):
        stay(tables)
    assert abs(puck_motion(tables.states)[0, 0] - [0.6, 1.4][player]) < 1e-12
    assert tables.states["fouls"][0].tolist() == [0, 0]
    stay(tables)
    puck = puck_motion(tables.states)[0]
    assert puck[0] == pytest.approx([1.4, 0.6][player]) and 0.25 <= puck[1] <= 0.75 and puck[2:].tolist() == [0, 0]
    np.testing.assert_allclose(mallet_motion(tables.states)[0, :, :2], [[0.25, 0.5], [1.75, 0.5]])
    assert tables.states["fouls"][0].tolist() == ([1, 0] if player == 0 else [0, 1])
    assert tables.rewards[0, player] == pytest.approx(-1.0 - STAYING_COST, abs=1e-6)
    assert tables.rewards[0, 1 - player] == pytest.approx(-STAYING_COST, abs=1e-7)
    assert tables.states["held"][0] == 0 and tables.states["defending"][0].tolist() == [1, 1]
    assert not tables.terminated[0] and tables.states["score"][0].tolist() == [0, 0]


def face_off_due(tables: Tables) -> None:
    """The next step ends the seven seconds."""
    tables.states["held"] = 6.95
    stay(tables)
    puck = puck_motion(tables.states)[0]
    assert tables.states["fouls"][0].tolist() == [0, 0] and tables.rewards.max() > -0.01
    assert puck[0] == 1.0 and 0.2 <= puck[1] <= 0.8 and 0.3 <= np.hypot(*puck[2:]) <= 0.8


@pytest.mark.parametrize("player", [0, 1])
def test_a_puck_out_of_reach_is_faced_off(player):
    """A mallet of 0.1 m does not come to a puck of 1 cm in a corner: their middles stay 0.127 m apart."""
    tables = make("match-v0", parameters={**FRICTIONLESS, "mallet_radius": 0.1, "puck_radius": 0.01})
    park(tables)
    put_puck(tables, 0.01, 0.01, player=player)
    face_off_due(tables)


def test_a_puck_in_a_corner_is_within_reach():
    tables = make("match-v0")
    park(tables)
    put_puck(tables, 0.031, 0.031)
    tables.states["held"] = 6.95
    stay(tables)
    assert tables.states["fouls"][0].tolist() == [1, 0]


def test_a_puck_on_the_middle_line_is_faced_off():
    tables = make("match-v0")
    park(tables)
    put_puck(tables, 1.0, 0.3)
    face_off_due(tables)


def test_fouls_outlast_an_automatic_reset_and_are_told():
    tables = make("match-v0", autoreset=True)
    tables.states["fouls"], tables.states["steps"] = (2, 3), 1799
    park(tables)
    stay(tables)
    assert tables.terminated[0] and tables.states["fouls"][0].tolist() == [0, 0]
    printed = outcome_info(tables, np.array([1]))
    assert printed["fouls"].tolist() == [[3, 2]]


@pytest.mark.parametrize("passive", ["still", "goalie"])
def test_a_player_that_never_attacks_loses(passive):
    """Before, held pucks were faced off: games against them ended 0:0."""
    result = play("match-v0", "interceptor", passive, 20, seed=1)
    assert result.wins[0] > 2 * result.wins[1]


def test_crossing_the_middle_starts_the_seven_seconds_anew():
    tables = make("match-v0")
    park(tables)
    tables.states["held"] = 6.85
    put_puck(tables, 0.95, 0.3, 1.0)
    stay(tables)
    assert tables.states["held"][0] == pytest.approx(0.05)  # it crossed in the middle of the step
    assert puck_motion(tables.states)[0].tolist() == pytest.approx([1.05, 0.3, 1.0, 0.0])


def test_no_fouls_in_drills():
    tables = make("attack-v0")
    park(tables)
    for _ in range(99):
        stay(tables)
        assert not tables.terminated[0] and not tables.truncated[0]
    assert puck_motion(tables.states)[0].tolist() == [0.6, 0.3, 0.0, 0.0]


@pytest.mark.parametrize(
    "variant, puck, ending, winner",
    [
        ("defence-v0", (0.6, 0.3, 0.02, 0.6), "clear", 0),
        ("defence-v0", (0.1, 0.5, -3.0, 0.0), "conceded", 1),
        ("defence-v0", (0.95, 0.5, 3.0, 0.0), "possession lost", -1),
        ("defence-v0", (1.05, 0.5, -1.0, 0.0), "running", None),
        ("attack-v0", (0.95, 0.5, 3.0, 0.0), "shot on goal", 0),
        ("attack-v0", (0.95, 0.3, 3.0, 0.0), "shot missed", 1),
        ("attack-v0", (0.1, 0.5, -3.0, 0.0), "conceded", 1),
        ("attack-v0", (0.6, 0.3, 0.02, 0.6), "running", None),
        ("attack-v0", (1.05, 0.5, -1.0, 0.0), "running", None),
    ],
)
@pytest.mark.parametrize("subject", [0, 1])
def test_endings_of_drills(variant, puck, ending, winner, subject):
    """Of the player whose drill it is; the winner counted from it. A turned table has the other subject."""
    tables = make(variant)
    park(tables)
    tables.states["subject"] = subject
    tables.states["defending"][0, subject] = int(variant == "defence-v0")
    tables.states["defending"][0, 1 - subject] = int(variant == "attack-v0")
    put_puck(tables, *puck, player=subject)
    touch(tables, subject)
    stay(tables)
    assert outcome(tables)[0] == ending and not tables.truncated[0]
    if winner is not None:
        assert outcome(tables)[1] == (winner if subject == 0 or winner < 0 else 1 - winner)


@pytest.mark.parametrize("variant", ["match-v0", "defence-v0"])
@pytest.mark.parametrize("puck", [(0.95, 0.5, 3.0, 0.0), (0.6, 0.3, 0.02, 0.6)])
def test_a_puck_that_was_not_touched_is_neither_lost_nor_cleared(variant, puck):
    """It passes through: the defence goes on, and pays nothing."""
    tables = make(variant)
    park(tables)
    tables.states["defending"] = (1, 0)
    touch(tables, 1)
    put_puck(tables, *puck)
    stay(tables)
    assert not tables.terminated[0] and tables.states["defending"][0].tolist() == [1, 0]
    assert tables.rewards[0, 0] == pytest.approx(-STAYING_COST, abs=1e-7)


def test_a_touch_counts_until_the_puck_changes_halves():
    """A resting mallet is hit, the puck flies over the line and off the far wall back again."""
    tables = make("match-v0")
    park(tables)
    put_mallet(tables, 0, 0.5, 0.3)
    put_puck(tables, 0.7, 0.3, -3.0)
    stay(tables)
    assert tables.states["puck"]["touched"][0].tolist() == [1, 0]
    put_puck(tables, 0.95, 0.3, 3.0)
    stay(tables)
    assert tables.states["puck"]["touched"][0].tolist() == [0, 0]
    assert tables.rewards[0, 0] == pytest.approx(-0.05 - STAYING_COST, abs=1e-7)  # lost, and no shot on goal


def test_the_other_player_ends_no_drill():
    """A clear of the shooter's, in its own half, is its own affair."""
    tables = make("defence-v0")
    park(tables)
    put_mallet(tables, 1, 0.2, 0.2)
    tables.states["defending"] = 1
    put_puck(tables, 0.6, 0.3, 0.02, 0.6, player=1)
    touch(tables, 1)
    stay(tables)
    assert not tables.terminated[0] and tables.states["defending"][0].tolist() == [1, 0]


@pytest.mark.parametrize(
    "variant, ending, winner", [("attack-v0", "shot on goal", 0), ("defence-v0", "possession lost", -1)]
)
def test_a_shot_that_is_in_within_its_step_is_still_a_shot(variant, ending, winner):
    tables = make(variant)
    park(tables)
    put_puck(tables, 0.95, 0.5, 20.0)
    touch(tables, 0)
    stay(tables)
    assert tables.states["score"][0].tolist() == [0, 0] and outcome(tables) == (ending, winner)


@pytest.mark.parametrize("period, limit", [(0.1, 100), (0.05, 200), (1 / 120, 1200), (0.03, 333)])
@pytest.mark.parametrize("variant", DRILLS)
def test_drills_are_truncated_after_ten_seconds(variant, period, limit):
    tables = make(variant, period=period)
    park(tables)
    tables.states["steps"] = limit - 2
    stay(tables)
    assert not tables.truncated[0]
    stay(tables)
    assert tables.truncated[0] and not tables.terminated[0]
    assert outcome(tables) == ("step limit", -1)


@pytest.mark.parametrize("variant", ["match-v0", *DRILLS])
def test_max_cycles(variant):
    tables = make(variant, max_cycles=3, period=0.05)
    for step in range(1, 4):
        park(tables)
        stay(tables)
        assert bool(tables.truncated[0]) == (step == 3) and not tables.terminated[0]


def test_an_ending_in_the_last_step_is_no_truncation():
    tables = make("attack-v0", max_cycles=1)
    park(tables)
    put_puck(tables, 0.95, 0.5, 3.0)
    stay(tables)
    assert tables.terminated[0] and not tables.truncated[0]


@pytest.mark.parametrize("winner", [0, 1, -1])
def test_infos_at_the_end(winner):
    """Each agent reads its own points first."""
    env = TableEnv(find_variant("match-v0"))
    env.reset(seed=1)
    env.tables.states["score"] = score = {0: (3, 1), 1: (1, 3), -1: (2, 2)}[winner]
    env.tables.states["steps"] = 1799
    env.tables.states["fouls"] = (4, 0)
    park(env.tables)
    actions = staying(env.tables)[0]
    infos = env.step({"player_0": actions[0], "player_1": actions[1]})[4]
    name = None if winner < 0 else f"player_{winner}"
    outcome = {0: 1, 1: -1, -1: 0}[winner]
    told = [{"ending": "clock", "winner": name, "outcome": one, "is_success": one == 1} for one in (outcome, -outcome)]
    assert infos["player_0"] == {**told[0], "score": score, "fouls": (4, 0)}
    assert infos["player_1"] == {**told[1], "score": score[::-1], "fouls": (0, 4)}
