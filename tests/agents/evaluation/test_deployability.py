"""The load on the gantry, measured of players whose load is known."""

import numpy as np
import pytest

from agents.evaluation.deployability import measure_deployability, measure_robustness
from baselines.player import Player
from puckpilot_env.tables import Tables


class Nailed(Player):
    """Stays where it is, with a tenth of the highest voltage."""

    def act(self, observation):
        low, high = self.seat.action_bounds
        action = np.tile(np.append(observation[:1, :2], [1.0, 1.0]), (len(observation), 1))
        action[:, :2] = observation[:, :2]
        return np.clip(action, low, high).astype(np.float32)


class Twitchy(Player):
    """Alternates between two targets 0.1 m from each other, with the highest voltage."""

    turn = 0

    def act(self, observation):
        self.turn += 1
        place = [0.25, 0.5 + 0.05 * (-1) ** self.turn]
        return np.tile([*place, 10.0, 10.0], (len(observation), 1)).astype(np.float32)


def test_a_player_that_stays_still_puts_no_load_on_the_gantry():
    found = measure_deployability(Nailed, "still", 4, 0)
    table = Tables("match-v0", 1).nominal[0]
    home = 0.125 * table["length"] - table["mallet_radius"]  # where every point begins
    assert found.wall_margin_m == pytest.approx(home, abs=1e-3)
    assert (found.voltage_share, found.voltage_most) == (pytest.approx(0.1), pytest.approx(0.1))
    assert found.acceleration_m_s2 == pytest.approx(0.0, abs=1e-6) and found.jitter_m == pytest.approx(0.0, abs=1e-6)
    assert 0.1 < found.decision_us < 1e4


def test_a_player_that_alternates_targets_is_jerky():
    found = measure_deployability(Twitchy, "still", 4, 0)
    assert found.jitter_m == pytest.approx(0.1, abs=1e-3)
    assert found.voltage_share == found.voltage_most == pytest.approx(1.0)
    assert found.acceleration_m_s2 > 4 * 0.1 / 0.1**2  # 0.1 m from rest to rest within 0.1 s needs at least that


def test_robustness_names_every_delay_and_noise():
    found = measure_robustness("follower", "still", 4, 0).as_dict()
    delays, noises = found["delay_s"], found["noise_m"]
    assert isinstance(delays, list) and isinstance(noises, list)
    assert [row["at"] for row in delays] == [0.0, 0.02, 0.04, 0.06]
    assert [row["at"] for row in noises] == [0.0, 0.0005, 0.001, 0.002]
    assert delays[0] == noises[0]  # no delay and no noise are the same games
