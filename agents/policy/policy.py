"""A trained policy as an npz file, and as a player without torch.

The file holds arrays and a JSON text alone: nothing in it is executed when it is read.
"""

from __future__ import annotations

import json
import os
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.policy.decoder import FrameDecoder
from agents.policy.network import SQUASHES, Network
from agents.policy.scaling import InputMapping, Scaling
from agents.training.run_folder import RunFolder
from baselines.player import Player, Seat
from puckpilot_env.files import small_file
from puckpilot_env.files.npz_file import read_arrays
from puckpilot_env.files.whole_file import write_whole
from puckpilot_env.options.inputs import in_short

FORMAT = "puckpilot-policy-1"
SHIPPED = Path(__file__).parents[1] / "policies"  # the folder of shipped policies; NAME.npz there is one, by its name
PREFIX = "policy:"  # may precede a policy's name; without it a script's name means the script
ONNX = ".onnx"  # ending of a model of any library
OUTPUTS = 4  # target x, y and voltages x, y, before squashing
MOST_BYTES = 1 << 28  # of all arrays; a network of eight layers of 2048 is half of it
REAL = (np.float32, np.float64)
SCALING_ARRAYS = {"centre": "centre", "span": "span", "flip": "mirror_signs", "low": "low", "high": "high"}
"""Name of each array in the file, and the field of `Scaling` that it holds, in the order of the fields."""


@dataclass(frozen=True)
class Policy:
    """A network with its scaling, and where it comes from.

    - `columns`: names of the observation's columns that are the network's inputs; it also plays variants with others.
    - `about`: how it was made, as JSON: variant, command, seed, steps and the like.
    - `squash`: the function that brings outputs into -1 to 1, one of `network.SQUASHES`.
    """

    network: Network
    scaling: Scaling
    columns: tuple[str, ...]
    about: dict[str, Any]
    squash: str = "tanh"

    def save(self, path: Path) -> Path:
        """Write the policy to `path`, completely or not at all; returns `path`."""
        arrays: dict[str, Any] = {name: getattr(self.scaling, field) for name, field in SCALING_ARRAYS.items()}
        for layer, (w, b) in enumerate(zip(self.network.weights, self.network.biases, strict=True)):
            arrays[f"weights_{layer}"], arrays[f"biases_{layer}"] = w, b
        head = json.dumps({"format": FORMAT, "columns": self.columns, "about": self.about, "squash": self.squash})
        return write_whole(path, lambda draft: np.savez(draft, head=np.array(head), **arrays))


def load_policy(path: Path) -> Policy:
    """Read a policy. ValueError, in one line, for a file that is no policy, is truncated, or is inconsistent."""
    if path.suffix == ONNX:
        raise ValueError(f"{path} is an ONNX model, which plays and no more; expected an .npz of `puckpilot train`")
    try:
        arrays = read_arrays(path, MOST_BYTES)
        head = small_file.parse_json(str(arrays["head"]))
    except FileNotFoundError:
        raise ValueError(f"no policy at {path}") from None
    except Exception as error:  # a broken file breaks its readers in many ways: zlib's, zipfile's, numpy's, json's
        words = f"{path} is not a policy, or is truncated ({type(error).__name__})"
        raise ValueError(f"{words}; expected an .npz file that `puckpilot train` or `export` wrote") from None
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        raise ValueError(f"{path} is not of the format {FORMAT}")
    try:
        return _policy_from(arrays, head)
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} does not fit together: {error}") from None


def _policy_from(arrays: dict[str, NDArray[Any]], head: dict[str, Any]) -> Policy:
    """The policy of a file's arrays and head; KeyError, TypeError or ValueError where they are inconsistent."""
    layers = sum(name.startswith("weights_") for name in arrays)
    for name, array in arrays.items():
        if name != "head" and getattr(array, "dtype", None) not in REAL:
            raise ValueError(f"{name} is no array of real numbers")
    network = Network(*([arrays[f"{part}_{n}"] for n in range(layers)] for part in ("weights", "biases")))
    scaling = Scaling(*(arrays[name].astype(np.float32) for name in SCALING_ARRAYS))
    columns = tuple(head["columns"]) if isinstance(head["columns"], list) else ()
    if not columns or not all(isinstance(name, str) for name in columns):
        raise ValueError(f"columns is {in_short(head['columns'])}; expected a list of names")
    sizes = {"centre": len(columns), "span": len(columns), "flip": len(columns), "low": OUTPUTS, "high": OUTPUTS}
    for name, size in sizes.items():
        numbers = getattr(scaling, SCALING_ARRAYS[name])
        if numbers.shape != (size,) or not np.isfinite(numbers).all():
            raise ValueError(f"{name} has shape {numbers.shape}; expected ({size},) finite numbers")
    if not (scaling.span > 0.0).all():
        raise ValueError("span holds numbers that are not above 0")
    if network.sizes[0] != len(columns) or network.sizes[-1] != OUTPUTS:
        raise ValueError(f"a network of {network.sizes} for {len(columns)} columns and {OUTPUTS} outputs")
    if head["squash"] not in SQUASHES:
        raise ValueError(f"squash is {head['squash']!r}; known: {', '.join(SQUASHES)}")
    return Policy(network, scaling, columns, dict(head["about"]), head["squash"])


class PolicyPlayer(Player):
    """Plays a policy deterministically, without exploration."""

    def __init__(self, policy: Policy, seat: Seat) -> None:
        self.seat = seat
        self.policy = policy
        self.made_for = str(policy.about.get("variant", ""))
        scaling = policy.scaling
        self._decoder = FrameDecoder(seat) if FrameDecoder.is_needed(policy.columns, seat) else None
        observed = self._decoder.columns if self._decoder else list(seat.columns)
        self._index = InputMapping.by_name(scaling, policy.columns, observed).index
        self._input_scale = np.stack([scaling.centre, scaling.span])
        middle, half = 0.5 * (scaling.low + scaling.high), 0.5 * (scaling.high - scaling.low)
        self._output_scale = np.stack([middle, half, *seat.action_bounds]).astype(np.float32)

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """Actions (n, 4) float32, inside the seat's bounds, for observations (n, d) float32."""
        policy = self.policy
        if self._decoder:
            observation = self._decoder.decode(observation)
        return policy.network.decide(observation, self._index, self._input_scale, self._output_scale, policy.squash)


def policy_names() -> list[str]:
    """Names of the shipped policies, sorted."""
    return sorted(path.stem for path in SHIPPED.glob("*.npz") if "." not in path.stem)


def is_policy(name: str) -> bool:
    """Whether a player's name means a policy, existing or not: by the prefix, a shipped name, or a path."""
    as_path = name.endswith((".npz", ONNX)) or "/" in name or os.sep in name or Path(name).exists()
    return name.startswith(PREFIX) or name in policy_names() or (name != "" and as_path)


def policy_file(name: str) -> Path:
    """The file of a policy.

    `name` is a shipped policy's name, a file, or the folder of a training run, with or without the prefix `policy:`.
    ValueError, in one line, where there is no such policy.
    """
    name = name.removeprefix(PREFIX)
    if name in policy_names():
        return SHIPPED / f"{name}.npz"
    path = Path(name)
    if not name or not path.exists():
        shipped = "".join(f"'{one}', " for one in policy_names())
        raise ValueError(f"no policy '{name}'; expected {shipped}a policy's .npz file, or the folder of a training run")
    if not path.is_dir():
        return path
    file = RunFolder(path).policy
    if not file.exists():
        raise ValueError(
            f"no policy in the folder '{name}': it has no {file.name}; expected the folder of a training run, "
            "which has one after its first round"
        )
    return file


def variant_file(file: Path, variant: str) -> Path:
    """The file to play `variant` with: NAME.VARIANT.npz in the folder of `file` (NAME.npz) if it exists, else `file`;
    and so for .onnx.

    For example champion.attack-v0.npz plays attack-v0 for champion.npz.
    """
    own = file.with_name(f"{file.stem}.{variant.rsplit('/', 1)[-1]}{file.suffix}")
    return own if own.exists() else file


def find_policy(name: str) -> Policy:
    """The policy of this name (see `policy_file`). ValueError, in one line, if it cannot be loaded."""
    return load_policy(policy_file(name))


def find_policy_player(name: str) -> Callable[[Seat], Player]:
    """A function that makes the policy's player for a seat, with the file for the seat's variant (see `variant_file`).

    `name` is as in `policy_file`, or an ONNX model of any library (see `onnx_player`). ValueError, in one line, if the
    policy cannot be loaded.
    """
    file = policy_file(name)
    policy = None if file.suffix == ONNX else load_policy(file)  # so that a broken file is refused before any game
    return partial(_make_player, file, policy)


def _make_player(file: Path, policy: Policy | None, seat: Seat) -> Player:
    own = variant_file(file, seat.variant)
    if own == file and policy is not None:
        return PolicyPlayer(policy, seat)
    if own.suffix == ONNX:
        from agents.policy.onnx_player import OnnxPlayer

        return OnnxPlayer(own, seat)
    return PolicyPlayer(load_policy(own), seat)
