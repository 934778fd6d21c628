"""The Gymnasium ids: by the book, the same alone and in a batch, fair to both seats, and no array shared."""

from __future__ import annotations

import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

import puckpilot_env
from baselines.gymnasium_seat import make_seat, make_seats
from baselines.players.goalie import Goalie

IDS = list(puckpilot_env.all_variants())
DRILL = "puckpilot/defence-randomized-v0"  # short episodes, and something is drawn for each


class Recorder:
    """An opponent that stays in the middle and notes what it is told."""

    def __init__(self, shape: tuple[int, ...]) -> None:
        self.shape = shape
        self.masks: list[np.ndarray] = []
        self.seen: list[np.ndarray] = []
        self.seeds: list[int] = []

    def seed(self, seed: int) -> None:
        self.seeds.append(seed)

    def reset(self, mask: np.ndarray) -> None:
        self.masks.append(mask.copy())

    def act(self, observation: np.ndarray) -> np.ndarray:
        self.seen.append(observation)
        return np.full(self.shape, 0.5)


def sample_actions(space: gymnasium.Space, count: int) -> list[np.ndarray]:
    space.seed(7)
    return [space.sample() for _ in range(count)]


@pytest.mark.parametrize("id_", IDS)
def test_gymnasium_finds_nothing_to_say(id_: str) -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = gymnasium.make(id_, opponent="interceptor", seat=1)
        env.reset(seed=1)
        for action in sample_actions(env.action_space, 30):
            _, _, terminated, truncated, _ = env.step(action)
            if terminated or truncated:
                env.reset()
        env.close()
        warnings.filterwarnings("ignore", ".*symmetric and normalized space")  # metres and volts are not
        check_env(gymnasium.make(id_).unwrapped)


@pytest.mark.parametrize("seat", [0, 1])
def test_first_row_of_a_batch_is_the_single_env(seat: int) -> None:
    one = make_seat(DRILL, "veteran", seat)
    many = make_seats(DRILL, 5, "veteran", seat, threads=2)
    single, _ = one.reset(seed=9)
    np.testing.assert_array_equal(single, many.reset(seed=9)[0][0])
    ends = 0
    for actions in sample_actions(many.action_space, 60):
        single, reward, terminated, truncated, info = one.step(actions[0])
        rows, rewards, terminations, truncations, infos = many.step(actions)
        assert (reward, terminated, truncated) == (rewards[0], terminations[0], truncations[0])
        if terminated or truncated:
            np.testing.assert_array_equal(single, infos["final_obs"][0])
            assert info["ending"] == infos["final_info"]["ending"][0]
            assert info["outcome"] == infos["final_info"]["outcome"][0]
            single, _ = one.reset()
            ends += 1
        np.testing.assert_array_equal(single, rows[0])
    assert ends >= 2


def test_infos_of_ended_tables_and_of_no_others() -> None:
    envs = make_seats("defence-v0", 16, "still")
    rows, _ = envs.reset(seed=1)
    counts = {-1: 0, 0: 0, 1: 0}
    for actions in sample_actions(envs.action_space, 40):
        before, (rows, _, terminated, truncated, infos) = rows, envs.step(actions)
        ended = terminated | truncated
        if not ended.any():
            assert infos == {}
            continue
        np.testing.assert_array_equal(infos["_final_obs"], ended)
        np.testing.assert_array_equal(infos["_final_info"], ended)
        for table in range(16):
            last, final = infos["final_obs"][table], infos["final_info"]
            if not ended[table]:
                assert last is None and final["ending"][table] is None and final["outcome"][table] == 0
                continue
            assert last in envs.single_observation_space
            assert not np.array_equal(last, rows[table]) and not np.array_equal(last, before[table])
            counts[final["outcome"][table]] += 1
            if final["ending"][table] == "conceded":
                assert final["outcome"][table] == (1 if final["score"][table, 0] else -1)
                assert final["score"][table].sum() == 1
    assert counts[-1] > 0 and counts[1] > 0


def test_seats_see_the_same_table_from_their_own_end() -> None:
    first, second = make_seat("match-v0", "still"), make_seat("match-v0", "still", seat=1)
    mine, theirs = first.reset(seed=4)[0], second.reset(seed=4)[0]
    columns = [column.name for column in first.tables.observation_columns]
    for name, mirrored in (("puck_x", 2.0), ("puck_y", 1.0), ("puck_vx", 0.0), ("puck_vy", 0.0), ("mallet_x", 0.5)):
        k = columns.index(name)
        assert mine[k] + theirs[k] == pytest.approx(mirrored, abs=1e-6), name
    assert abs(mine[columns.index("puck_vx")]) > 0.1
    for env in (first, second):  # each moves its own mallet
        seen, *_ = env.step(np.array([0.9, 0.5, 10.0, 10.0], np.float32))
        assert seen[columns.index("mallet_x")] > 0.3
        assert seen[columns.index("opponent_x")] == pytest.approx(1.75, abs=0.01)


def test_alternate_seats_are_the_rows_of_either_seat() -> None:
    made = {seat: make_seats("match-randomized-v0", 4, "interceptor", seat) for seat in (0, 1, "alternate")}
    rows = {seat: envs.reset(seed=2) for seat, envs in made.items()}
    expected = np.where(np.arange(4)[:, None] % 2 == 0, rows[0][0], rows[1][0])
    np.testing.assert_array_equal(rows["alternate"][0], expected)
    gantry = rows["alternate"][1]["gantry_scale"]
    np.testing.assert_array_equal(gantry[::2], rows[0][1]["gantry_scale"][::2])
    np.testing.assert_array_equal(gantry[1::2], rows[1][1]["gantry_scale"][1::2])
    actions = sample_actions(made[0].action_space, 1)[0]
    steps = {seat: envs.step(actions) for seat, envs in made.items()}
    np.testing.assert_array_equal(steps["alternate"][0][::2], steps[0][0][::2])
    np.testing.assert_array_equal(steps["alternate"][1][1::2], steps[1][1][1::2])
    assert not np.array_equal(steps["alternate"][0][1::2], steps[0][0][1::2])


def test_a_seed_brings_the_same_game_opponent_included() -> None:
    def play(env: gymnasium.Env, seed: int) -> np.ndarray:
        seen = [env.reset(seed=seed)[0]]
        return np.array(seen + [env.step(action)[0] for action in actions])

    env, other = make_seat("match-v0", "random"), make_seat("match-v0", "random")
    actions = sample_actions(env.action_space, 20)
    one = play(env, 5)
    np.testing.assert_array_equal(one, play(env, 5))
    np.testing.assert_array_equal(one, play(other, 5))
    assert not np.array_equal(one[0], play(env, 6)[0])
    assert not np.array_equal(env.reset()[0], make_seat("match-v0").reset()[0])  # unseeded ones differ


@pytest.mark.parametrize("bad", [np.nan, 11.0, -1.0])
def test_refused_actions_change_nothing(bad: float) -> None:
    env, other = make_seat("match-v0", "random"), make_seat("match-v0", "random")
    env.reset(seed=5)
    other.reset(seed=5)
    good = sample_actions(env.action_space, 1)[0]
    wrong = good.copy()
    wrong[2] = bad
    with pytest.raises(ValueError, match=r"volts_x of player_0 .* expected a number in"):
        env.step(wrong)
    np.testing.assert_array_equal(env.step(good)[0], other.step(good)[0])


def test_arrays_belong_to_the_caller() -> None:
    envs = make_seats("match-v0", 3, "goalie")
    actions = sample_actions(envs.action_space, 3)
    kept = [envs.reset(seed=1)[0], *envs.step(actions[0])[:4]]
    copies = [array.copy() for array in kept]
    envs.step(actions[1])
    for array, copy in zip(kept, copies, strict=True):
        np.testing.assert_array_equal(array, copy)
    kept[1][:] = 0.0
    assert envs.tables.observations.any()
    view = make_seats("match-v0", 3, "goalie", copy=False)
    seen, _ = view.reset(seed=1)
    np.testing.assert_array_equal(seen, copies[0])
    assert np.shares_memory(seen, view.step(actions[0])[0])


def test_an_opponent_object_is_told_what_it_has_to_know() -> None:
    opponent = Recorder((4, 4))
    envs = make_seats("attack-v0", 4, opponent, "alternate", max_cycles=9)
    envs.reset(seed=3)
    assert opponent.seeds == [3] and opponent.masks[0].all()
    printed = []
    for actions in sample_actions(envs.action_space, 30):
        seen = envs.tables.observations[[0, 1, 2, 3], [1, 0, 1, 0]].copy()
        _, _, terminated, truncated, _ = envs.step(actions)
        np.testing.assert_array_equal(opponent.seen[-1], seen)
        printed += [terminated | truncated] if (terminated | truncated).any() else []
    assert len(printed) >= 3
    np.testing.assert_array_equal(opponent.masks[1:], printed)
    envs.reset()
    assert opponent.seeds == [3] and opponent.masks[-1].all()


def test_a_class_of_players_is_as_good_as_its_name() -> None:
    one, two = (make_seats("match-v0", 2, opponent) for opponent in ("goalie", Goalie))
    np.testing.assert_array_equal(one.reset(seed=1)[0], two.reset(seed=1)[0])
    actions = sample_actions(one.action_space, 1)[0]
    np.testing.assert_array_equal(one.step(actions)[0], two.step(actions)[0])


def test_pictures() -> None:
    env = make_seat("match-v0", "still", render_mode="rgb_array")
    envs = make_seats("match-v0", 2, "still", seat="alternate", render_mode="rgb_array")
    env.reset(seed=1)
    envs.reset(seed=1)
    picture, pictures = env.render(), envs.render()
    assert picture is not None and pictures is not None and len(pictures) == 2
    np.testing.assert_array_equal(picture, pictures[0])
    assert make_seat("match-v0").render() is None and make_seats("match-v0").render() is None


@pytest.mark.parametrize(
    ("mistake", "words"),
    [
        (
            lambda: gymnasium.make("puckpilot/match-v0", opponent="goaly"),
            "unknown player 'goaly'; did you mean 'goalie'",
        ),
        (lambda: make_seat("match-v0", opponent=3), "opponent is 3; expected"),  # pyright: ignore[reportArgumentType] - what is refused
        (lambda: make_seat("match-v0", seat=2), "seat is 2; expected 0 or 1"),
        (lambda: make_seats("match-v0", 2, seat="both"), "seat is 'both'; expected 0, 1 or 'alternate'"),
        (lambda: make_seats("match-v0", render_mode="human"), "render_mode is 'human'"),
        (lambda: make_seats("match-v0", 0), "num_envs is 0"),
        (lambda: make_seats("match-v0", 2).reset(seed=[1, 2]), r"seed is \[1, 2\]"),  # pyright: ignore[reportArgumentType] - what is refused
        (lambda: make_seats("match-v0", 2).reset(options={"reset_mask": np.ones(2, bool)}), "reset_mask"),
        (lambda: make_seat("match-v0").step(np.ones(4, np.float32)), r"call reset\(\)"),
        (lambda: make_seats("match-v0").step(np.ones((1, 4))), r"call reset\(\)"),
    ],
)
def test_mistakes_are_named_in_one_line(mistake, words: str) -> None:
    with pytest.raises(ValueError, match=words) as caught:
        mistake()
    assert "\n" not in str(caught.value)


def test_wrong_shapes_and_a_step_too_many_are_refused() -> None:
    env = make_seat("match-v0", max_cycles=1)
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"shape \(1, 4\); expected \(4,\)"):
        env.step(np.ones((1, 4), np.float32))
    assert env.step(env.action_space.sample())[3]
    with pytest.raises(ValueError, match="the episode is over"):
        env.step(env.action_space.sample())
    envs = make_seats("match-v0", 2, Recorder((1, 4)))
    envs.reset(seed=1)
    with pytest.raises(ValueError, match=r"the actions have shape \(4,\); expected \(2, 4\)"):
        envs.step(np.ones(4))
    with pytest.raises(ValueError, match=r"opponent's actions have shape \(1, 4\)"):
        envs.step(sample_actions(envs.action_space, 1)[0])
