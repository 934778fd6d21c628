"""How to train, as a file in `agents/presets/` or of the user's own."""

from __future__ import annotations

import tomllib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from agents.rewards import Rewards

FOLDER = Path(__file__).parent / "presets"
FLIPS = ("rows", "augment", "none")
COUNTS = ("tables", "steps", "round", "cap", "most")


@dataclass(frozen=True)
class Preset:
    """A preset's numbers, by the names of its file; see the comments in `agents/presets/fast.toml`."""

    text: str
    tables: int
    steps: int
    round: int
    flip: str
    hidden: tuple[int, ...]
    distribution: str
    ppo: dict[str, Any]
    rewards: Rewards
    anchors: dict[str, int]
    earlier: tuple[int, ...]
    gate: float
    cap: int
    most: int


def preset_names() -> list[str]:
    """Names of the shipped presets."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def find_preset(name: str) -> Preset:
    """A shipped preset by name, or one of the user's by path. ValueError, in one line, for one that cannot be read."""
    path = FOLDER / f"{name}.toml" if name in preset_names() else Path(name)
    try:
        text = path.read_text(encoding="utf-8")
    except OSError:
        raise ValueError(f"no preset '{name}'; known: {', '.join(preset_names())}, or a path to a .toml file") from None
    return read_preset(text, str(name))


def read_preset(text: str, name: str) -> Preset:
    """The preset of a TOML text. ValueError, in one line, for a text that is not one."""
    try:
        raw = tomllib.loads(text)
        network, league = raw.pop("network"), raw.pop("league")
        ppo, rewards = raw.pop("ppo"), Rewards(**raw.pop("rewards"))
        preset = Preset(
            text=text, ppo=ppo, rewards=rewards, **raw,
            hidden=tuple(network.pop("hidden")), **network,
            earlier=tuple(league.pop("earlier")), **league,
        )  # fmt: skip
    except (tomllib.TOMLDecodeError, KeyError, TypeError) as error:
        raise ValueError(f"preset {name}: {error}") from None
    if preset.flip not in FLIPS:
        raise ValueError(f"preset {name}: flip is {preset.flip!r}; expected one of {', '.join(FLIPS)}")
    if "gamma" not in preset.ppo:
        raise ValueError(f"preset {name}: [ppo] has no gamma, by which shaping and returns are discounted")
    _check_counts(preset, name)
    return preset


def _check_counts(preset: Preset, name: str) -> None:
    named = [(count, getattr(preset, count)) for count in COUNTS]
    named += [(part, size) for part in ("hidden", "earlier") for size in getattr(preset, part)]
    named += list(preset.anchors.items())
    for what, count in named:
        if type(count) is not int or count < 1:
            raise ValueError(f"preset {name}: {what} is {count!r}; expected a whole number from 1 on")
