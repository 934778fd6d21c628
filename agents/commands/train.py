"""Train a player by self-play: PPO against itself, earlier snapshots of itself, and scripts.

A run lives in a folder and saves itself after every round, about every half a minute: stop it with Ctrl-C, or kill it,
and --resume continues exactly from there. The newest player is always DIR/policy.npz; let it play with `puckpilot
match policy:DIR/policy.npz interceptor`. `tensorboard --logdir DIR` draws its curves.
"""

from __future__ import annotations

import argparse
import importlib.util
import sys
from contextlib import nullcontext
from pathlib import Path
from typing import TYPE_CHECKING, Any, NoReturn

if TYPE_CHECKING:
    from agents.training.run import Training
    from agents.training.run_folder import RunFolder
    from agents.training.settings import Settings

FOREVER = 1e18
PRESETS = Path(__file__).parents[1] / "presets"


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    known = ", ".join(sorted(path.stem for path in PRESETS.glob("*.toml")))
    parser.add_argument("--preset", metavar="NAME", help=f"how to train: {known}, or a .toml file (default fast)")
    parser.add_argument(
        "--show-preset", metavar="NAME", action=_Show, help="print one, to begin your own with, and end"
    )
    parser.add_argument("--out", type=Path, required=True, metavar="DIR", help="folder of the run")
    parser.add_argument(
        "--steps",
        type=float,
        default=FOREVER,
        metavar="N",
        help="stop after the round that brings so many steps in all",
    )
    parser.add_argument(
        "--minutes", type=float, default=FOREVER, metavar="M", help="stop after so many minutes of this call"
    )
    parser.add_argument(
        "--resume", action="store_true", help="go on with the run in DIR; options that it contradicts are refused"
    )
    parser.add_argument(
        "--start", metavar="RUN", help="begin with the networks of a run's folder, or with a policy, by name or file"
    )
    parser.add_argument("--variant", metavar="ID", help="what is played (default match-v0)")
    parser.add_argument("--seed", type=int, help="seed of everything random (default 0)")
    parser.add_argument("--threads", type=int, metavar="K", help="threads to learn on (default 1)")
    parser.add_argument("--device", metavar="NAME", help="where the networks are: cpu, cuda (default cpu)")
    parser.add_argument(
        "--at-table",
        action="store_true",
        help="with what is true of every physical table: plans that a board can brake, sights that are 20 ms old, an "
        "opponent with its mallet in a hand; the player learns the robot's seat alone",
    )
    parser.add_argument(
        "--effects",
        metavar="FILE",
        help="physics beyond the baseline, as `diagnose` writes it (turns the use of mirror symmetry off)",
    )
    parser.add_argument(
        "--draws",
        metavar="FILE",
        help="what differs from game to game, as `diagnose` writes it (turns the use of mirror symmetry off)",
    )
    parser.add_argument(
        "--residual",
        metavar="FILE",
        help="a network that corrects the simulator's steps, as `gap` writes it (turns the use of mirror symmetry off)",
    )


def run(args: argparse.Namespace) -> int:
    """Train. 0: done. ValueError, in one line, for what cannot be trained."""
    require_torch()
    from agents.commands.progress_display import pace
    from agents.commands.train_settings import new_settings, saved_settings
    from agents.training import distributed
    from agents.training.run_folder import RunFolder

    for name in ("steps", "minutes"):
        if not getattr(args, name) > 0:
            raise ValueError(f"--{name} is {getattr(args, name):g}; expected more than 0")
    if args.threads is not None and args.threads < 1:
        raise ValueError(f"--threads is {args.threads}; expected a whole number from 1 on")
    folder = RunFolder(args.out)
    is_first = distributed.rank() == 0  # of several processes one writes
    settings = saved_settings(args, folder) if args.resume else new_settings(args)  # before a folder is made
    with folder.locked() if is_first else nullcontext():
        if is_first and not args.resume:
            folder.begin(settings.as_dict())
        training = run_training(folder, settings, steps=args.steps, minutes=args.minutes, quiet=not is_first)
    fresh = training.rows[training.resumed_rounds :]
    if is_first:
        print(f"the rounds' medians: {pace(fresh)}" if fresh else "nothing was left to do")
        print(f"{training.steps:,} steps; the player is {folder.policy}")
    return 0


class _Show(argparse.Action):
    """Prints a preset and exits."""

    def __call__(
        self, parser: argparse.ArgumentParser, namespace: object, name: Any, option: object = None
    ) -> NoReturn:
        from agents.training.preset import find_preset

        print(find_preset(name).text, end="")
        raise SystemExit(0)


def require_torch() -> None:
    """ValueError, in one line, where the packages that training needs are not installed."""
    missing = [name for name in ("torch", "rsl_rl", "tensordict") if importlib.util.find_spec(name) is None]
    if missing:
        raise ValueError(f"training needs {', '.join(missing)}; install it with: pip install 'puckpilot[train]'")


def run_training(
    folder: RunFolder, settings: Settings, *, steps: float, minutes: float = FOREVER, quiet: bool = False
) -> Training:
    """Train until `steps` or `minutes`, from the folder's checkpoint if there is one; the caller holds its lock.

    ValueError, in one line, where training diverges.
    """
    from torch.utils.tensorboard import SummaryWriter

    from agents.commands.progress_display import ProgressDisplay
    from agents.training import distributed
    from agents.training.run import Training, train
    from agents.training.runner import DivergedError

    training = Training(folder, settings)
    with ProgressDisplay(quiet) as display:
        curves = None if distributed.rank() else SummaryWriter(str(folder.path))

        def report(row: dict[str, Any]) -> None:
            if curves:
                for name, value in row.items():
                    curves.add_scalar(name, value, row["steps"])
            display.show(row)

        try:
            train(training, steps=steps, seconds=60.0 * minutes, report=report)
        except DivergedError as error:
            kept = f"{folder.checkpoint} is as it was" if training.rows else "nothing of it is kept"
            raise ValueError(f"the losses are no numbers any more ({error}); {kept}") from None
        except KeyboardInterrupt:
            if not quiet:
                kept = (
                    f"{len(training.rows)} rounds are saved; --resume continues from there"
                    if training.rows
                    else "no round was completed; there is nothing to resume"
                )
                print(f"{folder.path}: {kept}", file=sys.stderr)
            raise
        finally:
            if curves:
                curves.close()
    return training
