"""A trained player as a file: numbers and names in an npz, played without torch. Nothing in it can run."""

from __future__ import annotations

import json
import os
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.decoder import Decoder
from agents.network import SQUASHES, Network
from agents.run_folder import RunFolder
from agents.scaling import Reading, Scaling
from baselines.player import Player, Seat
from puckpilot_env import small_file
from puckpilot_env.inputs import in_short
from puckpilot_env.whole_file import write_whole

FORMAT = "puckpilot-policy-1"
SHIPPED = Path(__file__).parent / "policies"  # NAME.npz there is a policy; see `of_variant` for what may lie beside it
PREFIX = "policy:"  # may stand before a policy's name; a script's name without it is the script
OUTPUTS = 4  # of target x, y and voltages x, y, before they are squashed
MOST_BYTES = 1 << 28  # of all arrays; a network of eight layers of 2048 is half of it
REAL = (np.float32, np.float64)
SCALINGS = ("centre", "span", "flip", "low", "high")


@dataclass(frozen=True)
class Policy:
    """A network, and how it reads and acts.

    - `squash`: how outputs become actions in -1 to 1, a name of `network.SQUASHES`.
    - `columns`: names of the observation's columns that it was made for; it plays where others are shown too.
    - `about`: what made it, as JSON can hold it: variant, command, seed, steps ...
    """

    network: Network
    scaling: Scaling
    columns: tuple[str, ...]
    about: dict[str, Any]
    squash: str = "tanh"

    def save(self, path: Path) -> Path:
        """Write it to `path`, whole or not at all."""
        arrays: dict[str, Any] = {name: getattr(self.scaling, name) for name in SCALINGS}
        for layer, (w, b) in enumerate(zip(self.network.weights, self.network.biases, strict=True)):
            arrays[f"weights_{layer}"], arrays[f"biases_{layer}"] = w, b
        head = json.dumps({"format": FORMAT, "columns": self.columns, "about": self.about, "squash": self.squash})
        return write_whole(path, lambda draft: np.savez(draft, head=np.array(head), **arrays))


def load_policy(path: Path) -> Policy:
    """The policy of a file. ValueError, in one line, for a file that is not one, is cut short, or does not fit."""
    if path.suffix == ".onnx":
        raise ValueError(f"{path} is for other programs; here the .npz of `puckpilot train` or `export` plays")
    try:
        small_file.check_regular(path, MOST_BYTES)
        arrays = _arrays(path)
        head = small_file.parse_json(str(arrays["head"]))
    except FileNotFoundError:
        raise ValueError(f"no policy at {path}") from None
    except Exception as error:  # a broken file breaks its readers in many ways: zlib's, zipfile's, numpy's, json's
        words = f"{path} is no policy, or is cut short ({type(error).__name__})"
        raise ValueError(f"{words}; expected an .npz file that `puckpilot train` or `export` wrote") from None
    if not isinstance(head, dict) or head.get("format") != FORMAT:
        raise ValueError(f"{path} is not of the format {FORMAT}")
    try:
        return _built(arrays, head)
    except (KeyError, TypeError, ValueError) as error:
        raise ValueError(f"{path} does not fit together: {error}") from None


def _arrays(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays of an npz by name; a few bytes that unfold to more than memory holds are refused first."""
    with zipfile.ZipFile(path) as members:
        if sum(member.file_size for member in members.infolist()) > MOST_BYTES:
            raise ValueError(f"it unfolds to more than {MOST_BYTES} bytes")
    with np.load(path, allow_pickle=False) as file:
        return {name: file[name] for name in file.files}


def _built(arrays: dict[str, NDArray[Any]], head: dict[str, Any]) -> Policy:
    layers = sum(name.startswith("weights_") for name in arrays)
    for name, array in arrays.items():
        if name != "head" and getattr(array, "dtype", None) not in REAL:
            raise ValueError(f"{name} is no array of real numbers")
    network = Network(*([arrays[f"{part}_{n}"] for n in range(layers)] for part in ("weights", "biases")))
    scaling = Scaling(*(arrays[name].astype(np.float32) for name in SCALINGS))
    columns = tuple(head["columns"]) if isinstance(head["columns"], list) else ()
    if not columns or not all(isinstance(name, str) for name in columns):
        raise ValueError(f"columns is {in_short(head['columns'])}; expected a list of names")
    wide = {"centre": len(columns), "span": len(columns), "flip": len(columns), "low": OUTPUTS, "high": OUTPUTS}
    for name, size in wide.items():
        numbers = getattr(scaling, name)
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
    """A policy at a seat; it does what it thinks best, without exploring."""

    def __init__(self, policy: Policy, seat: Seat) -> None:
        self.seat = seat
        self.policy = policy
        scaling = policy.scaling
        self._decoder = Decoder(seat) if Decoder.is_needed(policy.columns, seat) else None
        given = self._decoder.columns if self._decoder else list(seat.columns)
        self._index = Reading.of(scaling, policy.columns, given).index
        self._reads = np.stack([scaling.centre, scaling.span])
        middle, half = 0.5 * (scaling.low + scaling.high), 0.5 * (scaling.high - scaling.low)
        self._acts = np.stack([middle, half, *seat.action_bounds]).astype(np.float32)

    def act(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """observation: (n, d) float32; returns (n, 4) float32 actions inside the seat's bounds."""
        policy = self.policy
        if self._decoder:
            observation = self._decoder.decode(observation)
        return policy.network.decide(observation, self._index, self._reads, self._acts, policy.squash)


def policy_names() -> list[str]:
    """Names of the shipped policies."""
    return sorted(path.stem for path in SHIPPED.glob("*.npz") if "." not in path.stem)


def is_policy(name: str) -> bool:
    """Whether a player's name asks for a policy, be it there or not: by prefix, by a shipped name, or as a path."""
    as_path = name.endswith(".npz") or "/" in name or os.sep in name or Path(name).exists()
    return name.startswith(PREFIX) or name in policy_names() or (name != "" and as_path)


def policy_file(name: str) -> Path:
    """The file of a policy, which may be named by a shipped name, by its file, or by the folder of the run that made
    it, each with or without `policy:`. ValueError, in one line, where there is none."""
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


def of_variant(file: Path, variant: str) -> Path:
    """The file that plays a variant for the policy of `file`, NAME.npz: NAME.VARIANT.npz where it lies beside it, as
    champion.attack-v0.npz does, or else the file itself."""
    own = file.with_name(f"{file.stem}.{variant.rsplit('/', 1)[-1]}.npz")
    return own if own.exists() else file


def find_policy(name: str) -> Policy:
    """The policy that is named so; see `policy_file`. ValueError, in one line, for one that cannot be loaded."""
    return load_policy(policy_file(name))


def find_policy_player(name: str) -> Callable[[Seat], Player]:
    """What makes the player of this policy for a seat, as it plays the seat's variant; see `policy_file`."""
    file = policy_file(name)
    load_policy(file)  # a broken one is told of now
    return partial(_seated, file)


def _seated(file: Path, seat: Seat) -> Player:
    return PolicyPlayer(load_policy(of_variant(file, seat.variant)), seat)
