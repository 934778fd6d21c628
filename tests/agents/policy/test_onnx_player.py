"""ONNX models of anyone play, and what is none of them is refused in one line."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import onnx
import pytest
from onnx import TensorProto, helper, numpy_helper
from onnx.external_data_helper import set_external_data

from agents.policy.onnx_file import write_onnx
from agents.policy.onnx_player import OnnxPlayer
from agents.policy.policy import PolicyPlayer, find_policy_player, load_policy
from baselines.player import Seat
from puckpilot_env.tables import Tables
from tests.agents.policy.some_policy import made

TABLES = Tables("match-v0", 6, seed=2)
SEAT, SEEN = Seat.from_tables(TABLES), TABLES.observations[:, 0].copy()


def _model(path: Path, nodes: list[onnx.NodeProto], width: int = 4, **given: np.ndarray) -> Path:
    """A model from `seen` (n, 21) to `action` (n, width) of some nodes and constants."""
    ends = [helper.make_tensor_value_info(name, TensorProto.FLOAT, ["n", size])
            for name, size in (("seen", SEEN.shape[1]), ("action", width))]  # fmt: skip
    constants = [numpy_helper.from_array(array, name) for name, array in given.items()]
    graph = helper.make_graph(nodes, "g", ends[:1], ends[1:], constants)
    onnx.save(helper.make_model(graph, opset_imports=[helper.make_opsetid("", 17)], ir_version=8), str(path))
    return path


def test_a_model_without_names_sees_all_columns_and_is_clipped_to_the_bounds(tmp_path: Path) -> None:
    weights = np.zeros((SEEN.shape[1], 4), np.float32)
    weights[0, 0], weights[1, 1], weights[0, 2] = 1.0, -1.0, 1000.0  # puck_x, -puck_y, far beyond 10 V
    path = _model(tmp_path / "m.onnx", [helper.make_node("MatMul", ["seen", "w"], ["action"])], w=weights)
    actions = OnnxPlayer(path, SEAT).act(SEEN)
    low, high = SEAT.action_bounds
    expected = np.clip(np.column_stack([SEEN[:, 0], -SEEN[:, 1], 1000.0 * SEEN[:, 0], 0.0 * SEEN[:, 0]]), low, high)
    np.testing.assert_allclose(actions, expected, rtol=1e-6)
    assert actions.dtype == np.float32


def test_columns_are_taken_by_name(tmp_path: Path) -> None:
    """A model of match-v0 plays match-randomized-v0, whose columns stand elsewhere, as the same policy does."""
    policy, others = made(), Tables("match-randomized-v0", 5, seed=1)
    path, seat = write_onnx(policy, tmp_path / "m.onnx"), Seat.from_tables(others)
    assert list(seat.columns)[: len(policy.columns)] != list(policy.columns)
    expected = PolicyPlayer(policy, seat).act(others.observations[:, 0])
    np.testing.assert_allclose(OnnxPlayer(path, seat).act(others.observations[:, 0]), expected, atol=1e-5)


def test_a_player_is_found_by_its_file_and_that_for_a_variant(tmp_path: Path) -> None:
    write_onnx(made(), tmp_path / "m.onnx")
    write_onnx(made(seed=5), tmp_path / "m.match-v0.onnx")
    found = find_policy_player(str(tmp_path / "m.onnx"))(SEAT).act(SEEN)
    np.testing.assert_allclose(found, PolicyPlayer(made(seed=5), SEAT).act(SEEN), atol=1e-5)
    with pytest.raises(ValueError, match=r"m.onnx is an ONNX model, which plays and no more"):
        load_policy(tmp_path / "m.onnx")


def _outside(path: Path) -> None:
    """A model whose weights are another file's, by its path."""
    (path.parent / "secret").write_bytes(np.zeros(84, np.float32).tobytes())
    weights = numpy_helper.from_array(np.zeros((21, 4), np.float32), "w")
    set_external_data(weights, "secret")
    weights.ClearField("raw_data")
    _model(path, [helper.make_node("MatMul", ["seen", "w"], ["action"])], w=np.zeros((21, 4), np.float32))
    model = onnx.load(str(path))
    model.graph.initializer[0].CopyFrom(weights)
    path.write_bytes(model.SerializeToString())


NAN = np.full((21, 4), np.nan, np.float32)


@pytest.mark.parametrize(
    ("make", "said"),
    [
        (lambda path: path.write_bytes(b"no model"), "cannot be read (DecodeError); expected an ONNX model"),
        (_outside, "cannot be "),
        (lambda path: _model(path, [helper.make_node("Relu", ["seen"], ["action"])], 21), "gives (6, 21) for 6 obs"),
        (lambda path: _model(path, [helper.make_node("MatMul", ["seen", "w"], ["action"])], w=NAN), "or no numbers; "),
        (lambda path: _model(path, [helper.make_node("MatMul", ["seen", "w"], ["action"])], w=NAN[:5]),
         "cannot be run ("),
        (lambda path: write_onnx(made("match-sensors-v0"), path), "which puckpilot/match-v0 does not show"),
    ],
)  # fmt: skip
def test_what_does_not_play_is_refused_in_one_line(make: Callable[[Path], object], said: str, tmp_path: Path) -> None:
    make(tmp_path / "m.onnx")
    with pytest.raises(ValueError) as error:
        OnnxPlayer(tmp_path / "m.onnx", SEAT)
    assert said in str(error.value) and str(tmp_path / "m.onnx") in str(error.value) and "\n" not in str(error.value)
