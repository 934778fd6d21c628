"""What `puckpilot train` was told to train: with defaults for a new run; for one that goes on, does it fit?"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from agents.run_folder import RunFolder
    from agents.training import Settings

DEFAULTS = {
    "variant": "match-v0", "preset": "fast", "seed": 0, "threads": 1, "device": "cpu", "effects": None, "draws": None,
}  # fmt: skip
FEW = 8  # numbers of effects that are told one by one


def new_settings(args: argparse.Namespace) -> Settings:
    """The settings of a new run. An option that was not given is None in `args`. ValueError for what cannot be."""
    from agents.preset import find_preset
    from agents.training import Settings
    from puckpilot_env.draws_file import read_draws
    from puckpilot_env.effects_file import effect_values
    from puckpilot_env.variants import find_variant

    asked = {
        name: default if getattr(args, name) is None else getattr(args, name) for name, default in DEFAULTS.items()
    }
    if asked["seed"] < 0:
        raise ValueError(f"--seed is {asked['seed']}; expected a whole number from 0 on")
    effects = effect_values(asked["effects"]) if asked["effects"] else None
    draws = read_draws(asked["draws"]).as_dict() if asked["draws"] else None
    start = str(_start(args.start)) if args.start else None
    variant, preset = find_variant(asked["variant"]).id, find_preset(asked["preset"])
    return Settings(
        variant, asked["seed"], asked["threads"], preset, effects, draws, start=start, device=_device(asked["device"])
    )


def _device(name: str) -> str:
    """A device of torch's that is there."""
    import torch

    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError, NotImplementedError):  # torch says so in many ways
        raise ValueError(f"--device is '{name}', unusable for torch here; expected cpu, or cuda for a GPU") from None
    return name


def _start(name: str) -> Path:
    """A run's folder, all of whose networks are taken, or else a policy's file."""
    from agents.policy import policy_file

    return (Path(name) if Path(name).is_dir() else policy_file(name)).resolve()


def kept_settings(args: argparse.Namespace, folder: RunFolder) -> Settings:
    """The settings of the run in `folder`. ValueError, in one line, if an option that was given contradicts them."""
    from agents.training import Settings

    settings = Settings.from_dict(folder.settings())
    _device(settings.device)
    if args.start:
        raise ValueError(f"--resume goes on with the run in {folder.path} as it is; --start is for a new one")
    wrong = [
        f"--{name} is {getattr(args, name)} where the run has {has}"
        for name, has in _contradicted(args, settings).items()
    ]
    if wrong:
        raise ValueError(
            f"--resume goes on with the run in {folder.path} as it is, but {', '.join(wrong)}; "
            f"leave {'it' if len(wrong) == 1 else 'them'} out, or begin a new run in another folder"
        )
    return settings


def _contradicted(args: argparse.Namespace, settings: Settings) -> dict[str, str]:
    """What the run has, in words, by the name of each option that was given and says otherwise."""
    from agents.preset import find_preset
    from puckpilot_env.draws_file import read_draws
    from puckpilot_env.effects_file import effect_values
    from puckpilot_env.variants import find_variant

    found = {}
    if args.variant is not None and find_variant(args.variant).id != settings.variant:
        found["variant"] = settings.variant
    if args.preset is not None and find_preset(args.preset).text != settings.preset.text:
        found["preset"] = _name_of(settings.preset.text)
    for name in ("seed", "threads", "device"):
        if getattr(args, name) is not None and getattr(args, name) != getattr(settings, name):
            found[name] = str(getattr(settings, name))
    if args.effects is not None and effect_values(args.effects) != (settings.effects or {}):
        values = [f"{name} {value:.4g}" for name, value in (settings.effects or {}).items()]
        found["effects"] = "none" if not values else " ".join(values) if len(values) <= FEW else "others, in run.json"
    if args.draws is not None and read_draws(args.draws) != read_draws(settings.draws):
        found["draws"] = "others, in run.json" if settings.draws else "none"
    return found


def _name_of(text: str) -> str:
    """The shipped preset of this text."""
    from agents.preset import find_preset, preset_names

    same = (name for name in preset_names() if find_preset(name).text == text)
    return next(same, "one of its own, in run.json")
