"""An exported model acts as the player does, by ONNX's own reference evaluator."""

from itertools import pairwise

import numpy as np
import onnx
import pytest
from onnx.reference import ReferenceEvaluator

from agents.policy.network import SQUASHES, Network
from agents.policy.onnx_file import write_onnx
from agents.policy.policy import Policy, PolicyPlayer
from agents.policy.scaling import Scaling
from baselines.player import Seat
from puckpilot_env.tables import Tables


@pytest.mark.parametrize("squash", SQUASHES)
def test_the_onnx_model_acts_as_the_player(squash, tmp_path):
    tables = Tables("match-v0", 40, seed=4)
    rng, (low, high) = np.random.default_rng(0), tables.action_bounds
    for _ in range(5):
        tables.step(rng.uniform(low, high, (40, 2, 4)).astype(np.float32).clip(low, high))
    columns = tuple(column.name for column in tables.observation_columns)
    sizes = (len(columns), 16, 8, 4)
    layers = [rng.normal(size=(b, a)).astype(np.float32) for a, b in pairwise(sizes)]
    network = Network(layers, [rng.normal(size=b).astype(np.float32) for b in sizes[1:]])
    policy = Policy(network, Scaling.from_tables(tables), columns, {}, squash)
    path = write_onnx(policy, tmp_path / "player.onnx")
    given = {"observation": tables.observations[:, 0].copy()}
    (actions,) = np.asarray(ReferenceEvaluator(str(path)).run(None, given))
    played = PolicyPlayer(policy, Seat.from_tables(tables)).act(tables.observations[:, 0])
    np.testing.assert_allclose(actions, played, atol=1e-4)
    assert np.ptp(played, axis=0).min() > 0.01
    assert dict((one.key, one.value) for one in onnx.load(path).metadata_props)["columns"] == ",".join(columns)
    assert list(tmp_path.iterdir()) == [path]
