"""The network of a table's residuals: what a step of the simulator lacks, from state, action and prediction.

The file holds arrays and a JSON text alone: nothing in it is executed when it is read.
"""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.files import small_file
from puckpilot_env.files.npz_file import read_arrays
from puckpilot_env.files.whole_file import write_whole

Array = NDArray[np.float32]

FORMAT = "puckpilot-residual/1"
PERIOD = 0.1  # s of the step that is corrected
INPUTS = (
    "puck_x", "puck_y", "puck_vx", "puck_vy", "mallet_x", "mallet_y", "mallet_vx", "mallet_vy", "opponent_x",
    "opponent_y", "target_x", "target_y", "volts_x", "volts_y", "then_x", "then_y", "then_vx", "then_vy",
)  # fmt: skip
"""Numbers of the robot's frame [m, m/s, V]: when the step begins, of the robot's action (volts as they are planned,
less what a table's effects take), and `then`: the puck at the step's end as the simulator has it."""
OUTPUTS = ("x", "y", "vx", "vy")  # what is added to `then`
MOST_BYTES = 1 << 24  # of all arrays
MOST_LAYERS = 8
SCALES = {"centre": len(INPUTS), "span": len(INPUTS), "middle": len(OUTPUTS), "scale": len(OUTPUTS),
          "bound": len(OUTPUTS)}  # fmt: skip


@dataclass(frozen=True)
class Residual:
    """A multi-layer perceptron with tanh between its layers and a linear last layer; all arrays are float32.

    - `weights[l]` (outputs, inputs), `biases[l]` (outputs,) of layer l; the first takes INPUTS, the last gives OUTPUTS.
    - `centre`, `span` (18,): the network sees (input - centre)/span.
    - `middle`, `scale`, `bound` (4,) [m, m/s]: a correction is middle + scale output, at most `bound` either way.

    ValueError, in one line, for shapes that do not fit together, and for numbers that are not finite.
    """

    weights: Sequence[Array]
    biases: Sequence[Array]
    centre: Array
    span: Array
    middle: Array
    scale: Array
    bound: Array

    def __post_init__(self) -> None:
        for name in ("weights", "biases"):
            object.__setattr__(self, name, tuple(np.ascontiguousarray(one, np.float32) for one in getattr(self, name)))
        for name, size in SCALES.items():
            numbers = np.ascontiguousarray(getattr(self, name), np.float32)
            if numbers.shape != (size,) or not np.isfinite(numbers).all():
                raise ValueError(f"{name} has shape {numbers.shape}; expected ({size},) finite numbers")
            object.__setattr__(self, name, numbers)
        for name, numbers, sign in (("span", self.span, self.span > 0.0), ("bound", self.bound, self.bound >= 0.0)):
            if not sign.all():
                raise ValueError(f"{name} holds {float(numbers.min()):g}; expected no less than 0, and no 0 as a span")
        _check_layers(self.weights, self.biases)

    def __call__(self, inputs: NDArray[Any]) -> Array:
        """Corrections (n, 4) [m, m/s] for inputs (n, 18)."""
        hidden = (np.asarray(inputs, np.float32) - self.centre) / self.span
        last = len(self.weights) - 1
        for number, (w, b) in enumerate(zip(self.weights, self.biases, strict=True)):
            hidden = hidden @ w.T + b
            if number < last:
                hidden = np.tanh(hidden)
        return np.clip(self.middle + self.scale * hidden, -self.bound, self.bound)

    def save(self, path: Path) -> Path:
        """Write the network to `path`, completely or not at all; returns `path`."""
        arrays: dict[str, Any] = {name: getattr(self, name) for name in SCALES}
        for layer, (w, b) in enumerate(zip(self.weights, self.biases, strict=True)):
            arrays[f"weights_{layer}"], arrays[f"biases_{layer}"] = w, b
        head = json.dumps({"format": FORMAT, "inputs": INPUTS, "outputs": OUTPUTS, "period": PERIOD})
        return write_whole(path, lambda draft: np.savez(draft, head=np.array(head), **arrays))


def no_residual() -> Residual:
    """A network whose corrections are 0."""
    inputs, outputs = len(INPUTS), len(OUTPUTS)
    one, none = np.ones(inputs, np.float32), np.zeros(outputs, np.float32)
    return Residual([np.zeros((outputs, inputs), np.float32)], [none], 0.0 * one, one, none, none, none)


def load_residual(path: Path) -> Residual:
    """Read a network. ValueError, in one line that begins with the path, for a file that is none, or is broken."""
    try:
        arrays = read_arrays(path, MOST_BYTES)
        head = small_file.parse_json(str(arrays.pop("head")))
    except FileNotFoundError:
        raise ValueError(f"{path}: is not there; expected an .npz file with a network of residuals") from None
    except Exception as error:  # a broken file breaks its readers in many ways: zlib's, zipfile's, numpy's, json's
        words = f"{path}: is no network of residuals, or is truncated ({type(error).__name__})"
        raise ValueError(f"{words}; expected an .npz file that `puckpilot gap` wrote") from None
    expected = {"format": FORMAT, "inputs": list(INPUTS), "outputs": list(OUTPUTS), "period": PERIOD}
    if head != expected:
        raise ValueError(f"{path}: is not of the format {FORMAT}, with its inputs, outputs and period")
    try:
        layers = sum(name.startswith("weights_") for name in arrays)
        names = [[f"{part}_{n}" for n in range(layers)] for part in ("weights", "biases")]
        if set(arrays) != {*SCALES, *names[0], *names[1]}:
            raise ValueError(f"it holds {len(arrays)} arrays; expected {', '.join(SCALES)}, weights_N and biases_N")
        if any(array.dtype != np.float32 for array in arrays.values()):
            raise ValueError("its arrays are not all of float32")
        weights, biases = ([arrays[name] for name in part] for part in names)
        return Residual(weights, biases, *(arrays[name] for name in SCALES))
    except ValueError as error:
        raise ValueError(f"{path}: does not fit together: {error}") from None


def _check_layers(weights: Sequence[Array], biases: Sequence[Array]) -> None:
    """ValueError for layers that do not lead from the inputs to the outputs."""
    if len(weights) != len(biases) or not 0 < len(weights) <= MOST_LAYERS:
        raise ValueError(f"{len(weights)} layers of weights, {len(biases)} of biases; expected 1 to {MOST_LAYERS} each")
    size = len(INPUTS)
    for number, (w, b) in enumerate(zip(weights, biases, strict=True)):
        if w.ndim != 2 or w.shape[1] != size or b.shape != w.shape[:1] or 0 in w.shape:
            raise ValueError(f"layer {number} has weights {w.shape} and biases {b.shape} after {size} numbers")
        if not (np.isfinite(w).all() and np.isfinite(b).all()):
            raise ValueError(f"layer {number} holds numbers that are not finite")
        size = w.shape[0]
    if size != len(OUTPUTS):
        raise ValueError(f"the last layer gives {size} numbers; expected {len(OUTPUTS)}")
