"""Both seats of a twin in PettingZoo's form."""

from __future__ import annotations

import numpy as np
import pettingzoo
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot_env  # noqa: F401 - registers the ids
from puckpilot_env.variants import find_variant
from sim2real.table.faults import TableFaultError
from sim2real.table.game.two_seats import make_two_seats

MATCH = "puckpilot/match-v0"


@pytest.mark.slow
def test_each_seat_drives_its_own_mallet_and_sees_the_table_from_its_own_end() -> None:
    env = make_two_seats(find_variant(MATCH), "twin")
    simulated = pettingzoo.make("parallel", MATCH)
    assert env.possible_agents == simulated.possible_agents
    for agent in env.possible_agents:
        assert env.observation_space(agent) == simulated.observation_space(agent)
        assert env.action_space(agent) == simulated.action_space(agent)
    try:
        env.reset(seed=3)
        wanted = {"player_0": [0.5, 0.3, 8.0, 8.0], "player_1": [0.2, 0.7, 8.0, 8.0]}
        actions = {agent: np.array(action, np.float32) for agent, action in wanted.items()}
        for _ in range(8):
            observations, rewards, terminated, truncated, infos = env.step(actions)
        assert observations["player_0"][:2] == pytest.approx(actions["player_0"][:2], abs=0.005)
        assert observations["player_1"][:2] == pytest.approx(actions["player_1"][:2], abs=0.005)
        assert rewards["player_0"] < 0.0 and rewards["player_1"] < 0.0  # volts cost
        assert set(infos) == {"player_0", "player_1"} and infos["player_1"]["acts_at"] > infos["player_1"]["time"]
        assert not any(terminated.values()) and not any(truncated.values())
        with pytest.raises(ValueError, match="no action for player_1"):
            env.step({"player_0": actions["player_0"]})
        env._twin.camera.unplugged = True
        with pytest.raises(TableFaultError, match="no frame for"):
            env.step(actions)
        env._twin.camera.unplugged = False
        _, infos = env.clear()
        assert set(infos) == set(env.agents) == {"player_0", "player_1"}
        env.step(actions)
    finally:
        env.close()


@pytest.mark.parametrize(
    ("options", "words"),
    [
        ({"backend": "replay", "recording": "x"}, "backend 'replay' has one seat"),
        ({"backend": "twin", "opponent": "goalie"}, "opponent is given, but both seats are the caller's"),
    ],
)
def test_what_has_not_two_seats_is_refused(options: dict, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        pettingzoo.make("parallel", MATCH, **options)
