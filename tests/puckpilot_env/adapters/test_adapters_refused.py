"""What no environment can take is refused in one line, whichever adapter it comes through, and changes nothing."""

from __future__ import annotations

import re
from typing import Any

import gymnasium
import numpy as np
import pettingzoo
import pytest

from puckpilot_env import Tables, match_v0
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.adapters.single_env import SingleEnv
from puckpilot_env.adapters.vector_env import TablesVectorEnv

ID = "puckpilot/match-v0"
MAKERS = {
    "parallel": lambda **options: pettingzoo.make("parallel", ID, **options),
    "aec": lambda **options: pettingzoo.make("aec", ID, **options),
    "single": lambda **options: gymnasium.make(ID, disable_env_checker=True, **options),
    "vector": lambda **options: gymnasium.make_vec(ID, num_envs=2, **options),
}


def refused(expected: str, call: Any, *args: Any, **options: Any) -> None:
    with pytest.raises(ValueError, match=f"^{re.escape(expected)}") as caught:
        call(*args, **options)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("kind", MAKERS)
@pytest.mark.parametrize(
    "options, expected",
    [
        ({"parameters": 3}, "parameters is 3; expected a dict"),
        ({"parameters": {"friction": 10**400}}, "parameter 'friction' is 1000"),
        ({"effects": 3}, "effects is 3; expected a dict"),
        ({"period": True}, "period is True; expected a number of seconds"),
        ({"period": float("nan")}, "period is nan; expected a number of seconds"),
        ({"max_cycles": 1.5}, "max_cycles is 1.5; expected a whole number"),
    ],
)
def test_options_of_an_environment(kind: str, options: dict[str, Any], expected: str) -> None:
    refused(expected, MAKERS[kind], **options)


@pytest.mark.parametrize("kind", MAKERS)
def test_arguments_of_a_reset(kind: str) -> None:
    env: Any = MAKERS[kind]()
    env.reset(seed=1, options={"anything": 1})
    before = env.unwrapped.state() if kind in ("parallel", "aec") else env.unwrapped.tables.states.copy()
    for options in (5, [1], "a", True):
        refused(f"options is {options!r}; expected a dict", env.reset, options=options)
    for seed in (-1, 1.0, "1", True, [1, 2], 2**64, np.zeros(1)):
        refused(f"seed is {seed!r}"[:40], env.reset, seed=seed)
    after = env.unwrapped.state() if kind in ("parallel", "aec") else env.unwrapped.tables.states
    assert after.tobytes() == before.tobytes()
    env.reset(seed=np.int64(3))


@pytest.mark.parametrize("seat", [2, -1, True, 1.0, None, "both", [0], np.zeros(2)])
def test_seats(seat: Any) -> None:
    refused("seat is ", gymnasium.make, ID, seat=seat)
    refused("seat is ", gymnasium.make_vec, ID, num_envs=2, seat=seat)


def test_numbers_of_numpy_are_seats() -> None:
    assert gymnasium.make(ID, seat=np.int64(1)).reset(seed=1)[0].shape == gymnasium.make(ID).observation_space.shape


@pytest.mark.parametrize("opponent", [None, 3, [3], "goaly"])
def test_opponents(opponent: Any) -> None:
    expected = (
        "unknown player 'goaly'; did you mean 'goalie'?" if opponent == "goaly" else f"opponent is {opponent and 3};"
    )
    refused(expected, gymnasium.make, ID, opponent=opponent)
    refused(expected, gymnasium.make_vec, ID, num_envs=2, opponent=opponent)


@pytest.mark.parametrize("render_mode", ["humane", 3, True, ["rgb_array"], np.zeros(2)])
def test_ways_to_render(render_mode: Any) -> None:
    expected = f"render_mode is {render_mode!r}; expected None, 'human' or 'rgb_array'"
    refused(expected, match_v0.parallel_env, render_mode=render_mode)
    tables, single = Tables("match-v0", 2), Tables("match-v0", 1, autoreset=False)
    refused(expected, SingleEnv, single, object(), render_mode=render_mode)
    refused(expected.replace(", 'human'", ""), TablesVectorEnv, tables, object(), render_mode=render_mode)


def test_what_is_no_batch_or_no_variant() -> None:
    for tables in (None, 3, Tables("match-v0", 2)):
        refused("expected Tables of one table with autoreset=False", SingleEnv, tables, object())
    for tables in (None, 3, Tables("match-v0", 2, autoreset=False)):
        refused("expected Tables with autoreset=True", TablesVectorEnv, tables, object())
    refused("variant is None; expected an id", TableEnv, None)


@pytest.mark.parametrize("num_envs", [0, True, 1.5, "2", -1])
def test_how_many_tables(num_envs: Any) -> None:
    from baselines.gymnasium_seat import make_seats

    refused(f"num_envs is {num_envs!r}; expected a whole number from 1", make_seats, ID, num_envs)
    refused("copy is 3; expected True or False", make_seats, ID, 2, copy=3)
    refused("threads is True; expected a whole number", make_seats, ID, 2, threads=True)


def test_actions_of_agents_that_are_not_there() -> None:
    env: Any = match_v0.parallel_env()
    env.reset(seed=1)
    before, action = env.state(), np.full(4, 0.4, np.float32)
    both = {"player_0": action, "player_1": action}
    expected = "actions has one for {}; expected them for player_0 and player_1 alone"
    refused(expected.format("'player_2'"), env.step, {**both, "player_2": action})
    refused(expected.format("0"), env.step, {0: action, **both})
    refused("no action for player_1; expected one for each of player_0, player_1", env.step, {"player_0": action})
    assert env.state().tobytes() == before.tobytes()


@pytest.mark.parametrize(
    "bad, expected",
    [
        ([[0.4], [0.4, 1.0]], "is [[0.4], [0.4, 1.0]]; expected real numbers, as many in each row"),
        ([10**400, 0, 1, 1], "has numbers of dtype object; expected real numbers"),
        ([0.4, 0.4, 1], "has shape (3,); expected (4,)"),
        (None, "has numbers of dtype object; expected real numbers"),
    ],
)
def test_actions_that_are_no_numbers(bad: Any, expected: str) -> None:
    env: Any = match_v0.parallel_env()
    env.reset(seed=1)
    good = np.full(4, 0.4, np.float32)
    refused(f"the action of player_1 {expected}", env.step, {"player_0": good, "player_1": bad})
    seat: Any = gymnasium.make(ID, disable_env_checker=True)
    seat.reset(seed=1)
    refused(f"the action {expected}", seat.step, bad)


@pytest.mark.filterwarnings("error")
def test_a_number_too_large_for_a_float32_is_outside_the_space() -> None:
    tables = Tables("match-v0", 1)
    actions = np.full((1, 2, 4), 0.4)
    actions[0, 1, 0] = 1e300
    refused("action target_x of player_1 on table 0 is inf; expected a number in [", tables.step, actions)
