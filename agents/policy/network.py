"""A trained network without torch: a multi-layer perceptron in one compiled forward pass."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.kernel import kernel

Array = NDArray[np.float32]
SQUASHES = ("tanh", "clip")  # what brings outputs into -1 to 1


class Network:
    """A multi-layer perceptron with ReLU between its layers and a linear last layer.

    `weights[l]` is (outputs, inputs) and `biases[l]` (outputs,) of layer l, as in torch's `nn.Linear`. `sizes`: inputs,
    then outputs of each layer. ValueError where shapes of successive layers do not match or a number is not finite.
    """

    def __init__(self, weights: Sequence[Array], biases: Sequence[Array]) -> None:
        self.weights = tuple(np.ascontiguousarray(w, np.float32) for w in weights)
        self.biases = tuple(np.ascontiguousarray(b, np.float32) for b in biases)
        self.sizes = _sizes(self.weights, self.biases)
        self._flat = np.concatenate([part for pair in self._transposed() for part in pair])
        self._sizes = np.array(self.sizes, np.int64)
        self._scratch = np.zeros((2, max(self.sizes)), np.float32)

    def _transposed(self) -> list[tuple[Array, Array]]:
        return [(w.T.ravel(), b) for w, b in zip(self.weights, self.biases, strict=True)]

    def __call__(self, inputs: Array) -> Array:
        """Outputs (n, outputs) float32 for inputs (n, inputs)."""
        outputs = np.empty((len(inputs), self.sizes[-1]), np.float32)
        _forward_all(self._flat, self._sizes, np.ascontiguousarray(inputs, np.float32), outputs, self._scratch)
        return outputs

    def decide(
        self, observations: Array, index: NDArray[np.int64], input_scale: Array, output_scale: Array,
        squash: str = "tanh",
    ) -> Array:  # fmt: skip
        """Actions (n, outputs) float32 for observations (n, d), scaling included, in one compiled pass.

        - `index` (inputs,): column of each input in the observation, negative for an input that is always 0.
        - `input_scale` (2, inputs): c and s; input j is (observation[index[j]] - c[j]) / s[j].
        - `output_scale` (4, outputs): m, h, low and high; action k is m[k] + h[k] squash(output k), clipped to
          low[k] and high[k].
        """
        actions = np.empty((len(observations), self.sizes[-1]), np.float32)
        _decide(
            self._flat,
            self._sizes,
            observations,
            index,
            input_scale,
            output_scale,
            squash == "tanh",
            actions,
            self._scratch,
        )
        return actions


def _sizes(weights: Sequence[Array], biases: Sequence[Array]) -> tuple[int, ...]:
    """Inputs, then outputs of each layer; ValueError for layers that do not make a network."""
    if not weights or len(weights) != len(biases):
        raise ValueError(f"{len(weights)} layers of weights and {len(biases)} of biases; expected one each, or more")
    sizes = [weights[0].shape[-1]]
    for number, (w, b) in enumerate(zip(weights, biases, strict=True)):
        if w.ndim != 2 or b.shape != w.shape[:1] or w.shape[1] != sizes[-1] or 0 in w.shape:
            raise ValueError(f"layer {number} has weights {w.shape} and biases {b.shape} after {sizes[-1]} numbers")
        if not (np.isfinite(w).all() and np.isfinite(b).all()):
            raise ValueError(f"layer {number} holds numbers that are not finite")
        sizes.append(w.shape[0])
    return tuple(sizes)


@kernel
def _add_scaled(out, scale, row):
    for k in range(out.size):
        out[k] += scale * row[k]


@kernel
def _forward(flat, sizes, scratch):
    """Forward pass from the inputs in `scratch[0]`; returns the row of `scratch` that holds the outputs.

    `flat`: transposed weights, then biases, of every layer; `sizes` (layers + 1,); `scratch` (2, widest layer).
    """
    at, here = 0, 0
    for layer in range(sizes.size - 1):
        fan_in, fan_out = sizes[layer], sizes[layer + 1]
        biases = at + fan_in * fan_out
        out = scratch[1 - here, :fan_out]
        for k in range(fan_out):
            out[k] = flat[biases + k]
        for j in range(fan_in):
            x = scratch[here, j]
            if layer == 0 or not x <= 0.0:  # ReLU at use, which skips about half of the work; NaN is passed on
                _add_scaled(out, x, flat[at : at + fan_out])
            at += fan_out
        at, here = biases + fan_out, 1 - here
    return here


@kernel
def _forward_all(flat, sizes, inputs, outputs, scratch):
    for row in range(inputs.shape[0]):
        for j in range(inputs.shape[1]):
            scratch[0, j] = inputs[row, j]
        here = _forward(flat, sizes, scratch)
        for k in range(outputs.shape[1]):
            outputs[row, k] = scratch[here, k]


@kernel
def _decide(flat, sizes, observations, index, input_scale, output_scale, with_tanh, actions, scratch):
    for row in range(observations.shape[0]):
        for j in range(index.size):
            at = index[j]
            scratch[0, j] = 0.0 if at < 0 else (observations[row, at] - input_scale[0, j]) / input_scale[1, j]
        here = _forward(flat, sizes, scratch)
        for k in range(actions.shape[1]):
            output = scratch[here, k]
            squashed = math.tanh(output) if with_tanh else output
            wanted = output_scale[0, k] + output_scale[1, k] * squashed
            actions[row, k] = min(max(wanted, output_scale[2, k]), output_scale[3, k])
