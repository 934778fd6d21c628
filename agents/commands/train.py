"""Train a player by self-play: PPO against itself, its earlier selves and scripts.

A run lives in a folder and saves itself after every round, about every half a minute: stop it with Ctrl-C, or kill it,
and --resume goes on as if nothing had happened. The newest player is always DIR/policy.npz; let it play with `puckpilot
match policy:DIR/policy.npz interceptor`. `tensorboard --logdir DIR` draws its curves.
"""

from __future__ import annotations

import argparse
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from agents.run_folder import RunFolder
    from agents.training import Settings

FOREVER = 1e18


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("--preset", default="fast", metavar="NAME", help="how to train: fast, paper, or a .toml file")
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the run")
    parser.add_argument("--steps", type=float, default=FOREVER, metavar="N", help="stop after so many steps in all")
    parser.add_argument("--minutes", type=float, default=FOREVER, metavar="M", help="stop after so many minutes")
    parser.add_argument("--resume", action="store_true", help="go on with the run in DIR, with its own settings")
    parser.add_argument("--variant", default="match-v0", metavar="ID", help="what is played (default match-v0)")
    parser.add_argument("--seed", type=int, default=0, help="seed of everything random (default 0)")
    parser.add_argument("--threads", type=int, default=1, metavar="K", help="threads to learn on (default 1)")
    parser.add_argument("--effects", metavar="FILE", help="physics beyond the baseline, as `diagnose` writes it")


def run(args: argparse.Namespace) -> int:
    """0: trained as long as was asked. Raises ValueError, in one line, for what cannot be trained."""
    try:
        import rsl_rl  # noqa: F401 - asked for here, where a word can be said about it
        import torch  # noqa: F401 - likewise
    except ImportError:
        raise ValueError("training needs torch and rsl-rl; install them: pip install 'puckpilot[train]'") from None
    from agents.run_folder import RunFolder

    for name in ("steps", "minutes"):
        if not getattr(args, name) > 0:
            raise ValueError(f"--{name} is {getattr(args, name):g}; expected more than 0")
    folder = RunFolder(args.out)
    with folder.locked():
        settings = _kept(folder) if args.resume else _begun(folder, args)
        return _train(folder, settings, args)


def _begun(folder: RunFolder, args: argparse.Namespace) -> Settings:
    from agents.preset import find_preset
    from agents.training import Settings
    from puckpilot_env.variants import find_variant

    settings = Settings(find_variant(args.variant).id, args.seed, args.threads, find_preset(args.preset), args.effects)
    kept = {"variant": settings.variant, "seed": args.seed, "threads": args.threads, "effects": args.effects}
    folder.begin({**kept, "preset": settings.preset.text})
    return settings


def _kept(folder: RunFolder) -> Settings:
    from agents.preset import read_preset
    from agents.training import Settings

    kept = folder.settings()
    preset = read_preset(kept["preset"], str(folder.run))
    return Settings(kept["variant"], kept["seed"], kept["threads"], preset, kept["effects"])


def _train(folder: RunFolder, settings: Settings, args: argparse.Namespace) -> int:
    from rich.console import Console
    from torch.utils.tensorboard import SummaryWriter

    from agents.training import Training, train

    console = Console(highlight=False)
    training = Training(folder, settings, resume=args.resume and folder.checkpoint.exists())
    writer = SummaryWriter(str(folder.path))
    shown: list[str] = []

    def tell(row: dict[str, Any]) -> None:
        for name, value in row.items():
            writer.add_scalar(name, value, row["steps"])
        if not shown:
            shown.append(_heading(row))
            console.print(shown[0])
        console.print(_line(row))

    try:
        train(training, steps=args.steps, seconds=60.0 * args.minutes, tell=tell)
    finally:
        writer.close()
    console.print(f"{training.steps:,} steps; the player is {folder.policy}")
    return 0


def _anchors(row: dict[str, Any]) -> list[str]:
    return [name.removeprefix("points_") for name in row if name.startswith("points_")]


def _heading(row: dict[str, Any]) -> str:
    anchors = "".join(f"{name:>13}" for name in _anchors(row))
    return f"{'round':>5} {'steps':>8} {'minutes':>7} {'steps/s':>8} {'selves':>6}   points won against{anchors}"


def _line(row: dict[str, Any]) -> str:
    shares = "".join(f"{100 * row[f'points_{name}']:>11.0f} %" for name in _anchors(row))
    return (
        f"{row['round']:>5} {row['steps'] / 1e6:>6.1f} M {row['seconds'] / 60:>7.1f} {row['steps_per_s']:>8,} "
        f"{row['selves']:>6}   {'':18}{shares}"
    )
