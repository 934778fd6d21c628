"""The whole chain on the twin: action, trajectory, flashed firmware, plant, camera, observation."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot_env  # noqa: F401 - registers the ids
from puckpilot_env.options.at_table import AT_TABLE
from sim2real.table.game.robot_seat import RobotSeat, make_robot_seat
from sim2real.table.game.two_seats import GivenActions
from sim2real.table.twin.hand import ScriptedHand
from tests.sim2real.table.seats import MATCH, STAY, twin_of


def test_it_has_the_spaces_of_the_simulator(seat: RobotSeat) -> None:
    simulated = gymnasium.make(MATCH, opponent="still")
    assert seat.observation_space == simulated.observation_space and seat.action_space == simulated.action_space
    observation, info = seat.reset(seed=1)
    assert seat.observation_space.contains(observation)
    assert info["acts_at"] > info["time"] and 0.0 < info["frame_age"] < 0.02


def test_the_mallet_goes_where_the_action_says_and_the_columns_say_so(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    target = np.array([0.6, 0.3, 8.0, 8.0], np.float32)
    observation, plant = np.zeros(0), twin_of(seat).plant
    for _ in range(8):
        observation, *_, info = seat.step(target)
    assert plant.mallet(0)[:2] == pytest.approx(target[:2], abs=0.001)
    assert observation[:4] == pytest.approx([0.6, 0.3, 0.0, 0.0], abs=0.005)
    assert info["off_path"] < 0.002


@pytest.mark.slow
def test_puck_and_opponent_are_seen_where_they_are_and_as_fast() -> None:
    env = make_robot_seat(MATCH, "twin", opponent="interceptor", seed=2)
    try:
        env.reset(seed=4)
        names = [column.name for column in env.tables.observation_columns]
        puck_at, opponent_at = names.index("puck_x"), names.index("opponent_x")
        places, speeds, others = [], [], []
        for _ in range(40):
            observation, *_, info = env.step(STAY)
            plant = twin_of(env).plant
            puck, ahead = plant.puck, info["acts_at"] - plant.time
            places.append(np.abs(observation[puck_at : puck_at + 2] - puck[:2] - ahead * puck[2:]).max())
            speeds.append(np.abs(observation[puck_at + 2 : puck_at + 4] - puck[2:]).max())
            others.append(np.abs(observation[opponent_at : opponent_at + 2] - plant.mallet(1)[:2]).max())
        assert np.median(places) < 0.003 and np.median(speeds) < 0.1 and np.median(others) < 0.03
        assert (np.array(places) > 0.05).sum() <= 2 and (np.array(speeds) > 1.0).sum() <= 4  # contacts meanwhile
    finally:
        env.close()


def test_the_hand_has_no_more_volts_than_plans_of_the_robot(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    twin, given = twin_of(seat), GivenActions()
    given.action[:] = 1.1, 0.1, 24.0, 24.0
    plan = ScriptedHand(seat.game, given, 1).decide(twin.plant, seat.game.record)
    assert 27.0 < abs(plan[0]) + abs(plan[1]) <= 2.0 * AT_TABLE["max_voltage"]


def played(seed: int, env: RobotSeat, steps: int = 10) -> tuple[list, list]:
    try:
        seen = [env.reset(seed=seed)[0]]
        random = np.random.default_rng(5)
        for _ in range(steps):
            action = random.uniform(*env.tables.action_bounds).astype(np.float32)
            seen.append(env.step(action)[0])
        board = twin_of(env).board
        assert board is not None
        return [one.tolist() for one in seen], list(board.machine.pwm)
    finally:
        env.close()


@pytest.mark.slow
def test_the_same_seed_gives_the_same_game_to_the_last_bit() -> None:
    env = make_robot_seat(MATCH, "twin", opponent="interceptor", seed=1)
    once = played(3, env)
    assert once == played(3, env) == played(3, make_robot_seat(MATCH, "twin", opponent="interceptor", seed=2))
    assert once[0] != played(4, env)[0]
    assert len(once[1]) > 100


@pytest.mark.slow
def test_the_same_seed_gives_the_same_pictures_and_the_same_game() -> None:
    env = make_robot_seat(MATCH, "twin", opponent="interceptor", camera="pictures")
    once = played(3, env, steps=3)
    other = make_robot_seat(MATCH, "twin", opponent="interceptor", camera="pictures")
    assert once == played(3, env, steps=3) == played(3, other, steps=3)
    assert once[0] != played(3, make_robot_seat(MATCH, "twin", opponent="interceptor"), steps=3)[0]  # of places


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"backend": "twinn"}, "unknown backend 'twinn'; did you mean 'twin'?"),
        ({"backend": "twin", "seat": 1}, "seat is given with backend 'twin'"),
        ({"backend": "twin", "period": 0.0125}, "period is 0.0125 s; the board takes a plan every 0.016 s"),
        ({"backend": "twin", "camara": "pictures"}, "camara is given with backend 'twin'; it takes opponent"),
        ({"backend": "twin", "errors": {"x": 1}}, "errors is {'x': 1}; expected a CameraErrors of sim2real.table.twin"),
        ({"backend": "twin", "law": 3}, "law is 3; expected a Law of sim2real.study.independent_table.physics.law"),
        ({"backend": "twin", "opponent": "goaly"}, "unknown player 'goaly'; did you mean 'goalie'?"),
    ],
)
def test_what_a_backend_cannot_do_is_refused_in_one_line(options: dict, words: str) -> None:
    with pytest.raises(ValueError) as caught:
        gymnasium.make(MATCH, **options)
    assert words in str(caught.value) and "\n" not in str(caught.value)


@pytest.mark.parametrize("variant", ["match-sensors-v0", "match-randomized-v0", "defence-v0"])
def test_variants_that_no_backend_plays_are_refused(variant: str) -> None:
    with pytest.raises(ValueError, match=f"puckpilot/{variant} is not played there yet"):
        gymnasium.make(f"puckpilot/{variant}", backend="twin")


def test_a_weak_supply_is_kept_to_and_what_the_twin_does_not_model_is_refused() -> None:
    env = make_robot_seat(MATCH, "twin", opponent="still", parameters={"max_voltage": 12.0})
    env.reset(seed=1)
    env.step(STAY)
    env.close()
    with pytest.raises(ValueError, match="the twin does not model 'camera_latency'"):
        make_robot_seat(MATCH, "twin", opponent="still", parameters={"camera_latency": 0.02})


def test_gymnasium_makes_the_twin_by_naming_it() -> None:
    env = gymnasium.make(MATCH, backend="twin", opponent="still")
    try:
        observation, _ = env.reset(seed=1)
        after, *_ = env.step(STAY)
        assert env.observation_space.contains(observation) and env.observation_space.contains(after)
    finally:
        env.close()


@pytest.mark.slow
def test_a_jammed_puck_is_a_foul_in_the_end_and_freed_by_the_hand_that_puts_it_down(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    plant = twin_of(seat).plant
    plant.put_puck(np.array([0.4, 0.9, 0.0, 0.0]))
    plant.jam(True)
    places = []
    for _ in range(90):
        *_, info = seat.step(STAY)
        places.append(plant.puck[:2])
        if info["new_point"]:
            break
    assert info["fouls"][0] == 1 and 6.9 < info["play_time"] < 7.6
    np.testing.assert_array_equal(places[:-1], np.tile([0.4, 0.9], (len(places) - 1, 1)))
    seat.step(STAY)
    assert np.linalg.norm(plant.puck[:2] - [0.4, 0.9]) > 0.1
