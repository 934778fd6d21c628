"""The settings of `puckpilot train` from its options: defaults for a new run, checks for one that is resumed."""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

from puckpilot_env.options.at_table import AT_TABLE

if TYPE_CHECKING:
    from agents.training.run_folder import RunFolder
    from agents.training.settings import Settings

DEFAULTS: dict[str, Any] = {
    "variant": "match-v0", "preset": "fast", "seed": 0, "threads": 1, "device": "cpu", "effects": None, "draws": None,
    "residual": None,
}  # fmt: skip
MOST_EFFECTS_LISTED = 8  # in a message; more are summed up


def new_settings(args: argparse.Namespace) -> Settings:
    """The settings of a new run.

    Options that were not given are None in `args`. ValueError for values that cannot be.
    """
    from agents.training.preset import find_preset
    from agents.training.settings import Settings
    from puckpilot_env.options.draws_file import read_draws
    from puckpilot_env.options.effects_file import effect_values
    from puckpilot_env.variants import find_variant

    given = {
        name: default if getattr(args, name) is None else getattr(args, name) for name, default in DEFAULTS.items()
    }
    if given["seed"] < 0:
        raise ValueError(f"--seed is {given['seed']}; expected a whole number from 0 on")
    effects = effect_values(given["effects"]) if given["effects"] else {}
    if args.at_table:
        other = [name for name, value in AT_TABLE.items() if effects.get(name, value) != value]
        if other:
            raise ValueError(f"--effects gives another {', '.join(other)} than --at-table; leave one of the two out")
        effects |= AT_TABLE
    draws = read_draws(given["draws"]).as_dict() if given["draws"] else None
    start = str(_start(args.start)) if args.start else None
    variant, preset = find_variant(given["variant"]).id, find_preset(given["preset"])
    variants = [variant, *(one.variant for one in preset.beside)]
    residual = _residual(given["residual"], variants) if given["residual"] else None
    return Settings(
        variant, given["seed"], given["threads"], preset, effects or None, draws, start=start,
        device=_device(given["device"]), residual=residual,
    )  # fmt: skip


def _residual(name: str, variants: list[str]) -> str:
    """Absolute path of a network of residuals that can be read, and can correct the variants."""
    from puckpilot_env.residual.network import load_residual
    from puckpilot_env.residual.tables import refuse_uncorrectable
    from puckpilot_env.variants import find_variant

    load_residual(Path(name))
    for variant in variants:
        refuse_uncorrectable(find_variant(variant))
    return str(Path(name).resolve())


def _device(name: str) -> str:
    """`name`, if torch can use this device; else ValueError."""
    import torch

    try:
        torch.zeros(1, device=name)
    except (RuntimeError, AssertionError, NotImplementedError):  # torch raises any of these
        raise ValueError(f"--device is '{name}', unusable for torch here; expected cpu, or cuda for a GPU") from None
    return name


def _start(name: str) -> Path:
    """Absolute path of a run's folder or of a policy's file."""
    from agents.policy.policy import policy_file

    return (Path(name) if Path(name).is_dir() else policy_file(name)).resolve()


def saved_settings(args: argparse.Namespace, folder: RunFolder) -> Settings:
    """The settings of the run in `folder`. ValueError, in one line, if a given option contradicts them."""
    from agents.training.settings import Settings

    settings = Settings.from_dict(folder.settings())
    _device(settings.device)
    if args.start:
        raise ValueError(f"--resume goes on with the run in {folder.path} as it is; --start is for a new one")
    wrong = [
        f"--{name} is {'given' if name == 'at-table' else getattr(args, name)} where the run has {has}"
        for name, has in _contradictions(args, settings).items()
    ]
    if wrong:
        raise ValueError(
            f"--resume goes on with the run in {folder.path} as it is, but {', '.join(wrong)}; "
            f"leave {'it' if len(wrong) == 1 else 'them'} out, or begin a new run in another folder"
        )
    return settings


def _contradictions(args: argparse.Namespace, settings: Settings) -> dict[str, str]:
    """For each given option that differs from the run's settings: its name, and the run's value in words."""
    from agents.training.preset import find_preset
    from puckpilot_env.options.draws_file import read_draws
    from puckpilot_env.options.effects_file import effect_values
    from puckpilot_env.variants import find_variant

    found = {}
    if args.variant is not None and find_variant(args.variant).id != settings.variant:
        found["variant"] = settings.variant
    if args.preset is not None and find_preset(args.preset).text != settings.preset.text:
        found["preset"] = _preset_name(settings.preset.text)
    for name in ("seed", "threads", "device"):
        if getattr(args, name) is not None and getattr(args, name) != getattr(settings, name):
            found[name] = str(getattr(settings, name))
    saved = settings.effects or {}
    if args.at_table and not saved.items() >= AT_TABLE.items():
        found["at-table"] = f"another {', '.join(name for name in AT_TABLE if saved.get(name) != AT_TABLE[name])}"
    if args.effects is not None and {**(AT_TABLE if args.at_table else {}), **effect_values(args.effects)} != saved:
        values = [f"{name} {value:.4g}" for name, value in saved.items()]
        found["effects"] = (
            "none" if not values else " ".join(values) if len(values) <= MOST_EFFECTS_LISTED else "others, in run.json"
        )
    if args.draws is not None and read_draws(args.draws) != read_draws(settings.draws):
        found["draws"] = "others, in run.json" if settings.draws else "none"
    if args.residual is not None and str(Path(args.residual).resolve()) != settings.residual:
        found["residual"] = settings.residual or "none"
    return found


def _preset_name(text: str) -> str:
    """Name of the shipped preset with this text."""
    from agents.training.preset import find_preset, preset_names

    same = (name for name in preset_names() if find_preset(name).text == text)
    return next(same, "one of its own, in run.json")
