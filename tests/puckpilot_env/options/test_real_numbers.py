"""Actions that are no real numbers are refused in one line that says whose they are, and change nothing."""

from __future__ import annotations

import gymnasium
import numpy as np
import pytest

from puckpilot_env import Tables, match_v0
from puckpilot_env.options.real_numbers import real_numbers

NO_NUMBERS = [np.array([0.5, 0.5, 1, 1 + 0j]), ["0.5", "a", "1", "1"], np.array([0.5, 0.5, 1, None])]


@pytest.mark.parametrize("given", [[1, 2], [True], [0.5], np.float32(1), 3])
def test_numbers_stay_as_they_are(given) -> None:
    np.testing.assert_array_equal(real_numbers(given, "it"), given)


@pytest.mark.parametrize("bad", NO_NUMBERS)
def test_what_is_no_number_is_refused_wherever_it_comes_in(bad) -> None:
    good = np.array([0.5, 0.5, 1, 1], np.float32)
    env, seat = match_v0.parallel_env(), gymnasium.make("puckpilot/match-v0", disable_env_checker=True)
    tables = Tables("match-v0", 2)
    env.reset(seed=1)
    seat.reset(seed=1)
    before = env.state()
    with pytest.raises(ValueError, match=r"^the action of player_1 has numbers of dtype [^ ]+; expected real numbers$"):
        env.step({"player_0": good, "player_1": bad})
    with pytest.raises(ValueError, match=r"^the action has numbers of dtype"):
        seat.step(bad)
    with pytest.raises(ValueError, match=r"^the array of actions has numbers of dtype"):
        tables.step([[bad, bad], [bad, bad]])  # pyright: ignore[reportArgumentType] - what is refused
    np.testing.assert_array_equal(env.state(), before)


@pytest.mark.parametrize("bad", [None, [np.zeros(4), np.zeros(4)], np.zeros((2, 4))])
def test_actions_that_are_no_dict_are_refused(bad) -> None:
    env = match_v0.parallel_env()
    env.reset(seed=1)
    with pytest.raises(ValueError, match=r"^actions is a [a-zA-Z]+; expected a dict with an action for each agent$"):
        env.step(bad)
