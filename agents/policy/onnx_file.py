"""Export of a policy as an ONNX model, from an agent's observation to its action, scaling included."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from agents.policy.policy import Policy
from puckpilot_env.files.whole_file import write_whole

OPSET = 17


def write_onnx(policy: Policy, path: Path) -> Path:
    """Write the model to `path`; returns `path`.

    Its input `observation` is (n, d) float32, in the order of the policy's columns, in SI units. Its output `action` is
    (n, 4) float32: target x, y [m] and voltages x, y [V].
    """
    import onnx
    from onnx import TensorProto, helper, numpy_helper

    nodes, constants = [], []
    name = "observation"

    def add(kind: str, *others: np.ndarray, **attributes: Any) -> None:
        nonlocal name
        given = [name]
        for other in others:
            given.append(f"constant_{len(constants)}")
            constants.append(numpy_helper.from_array(np.ascontiguousarray(other, np.float32), given[-1]))
        name = f"value_{len(nodes)}"
        nodes.append(helper.make_node(kind, given, [name], **attributes))

    scaling = policy.scaling
    add("Sub", scaling.centre)
    add("Div", scaling.span)
    layers = list(zip(policy.network.weights, policy.network.biases, strict=True))
    for number, (weights, biases) in enumerate(layers):
        add("Gemm", weights, biases, transB=1)
        if number < len(layers) - 1:
            add("Relu")
    if policy.squash == "tanh":
        add("Tanh")
    else:
        add("Clip", np.array(-1.0), np.array(1.0))
    add("Mul", 0.5 * (scaling.high - scaling.low))
    add("Add", 0.5 * (scaling.high + scaling.low))
    nodes[-1].output[0] = "action"
    sides = [
        helper.make_tensor_value_info(what, TensorProto.FLOAT, ["n", width])
        for what, width in (("observation", len(policy.columns)), ("action", len(scaling.low)))
    ]
    graph = helper.make_graph(nodes, "puckpilot-policy", sides[:1], sides[1:], constants)
    model = helper.make_model(graph, opset_imports=[helper.make_opsetid("", OPSET)], producer_name="puckpilot")
    model.ir_version = 8  # the version that goes with this opset
    helper.set_model_props(model, {"columns": ",".join(policy.columns)})
    onnx.checker.check_model(model)
    return write_whole(path, lambda draft: draft.write_bytes(model.SerializeToString()))
