"""Options and displays that the commands share."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from baselines.matches.match import Progress
from puckpilot_env.options import draws_file
from puckpilot_env.options.effects_file import described

if TYPE_CHECKING:
    from rich.console import Console
    from rich.table import Table


def add_options(parser: argparse.ArgumentParser) -> None:
    """Declare the options of every command that plays games."""
    parser.add_argument("--variant", default="match-v0", metavar="ID", help="what is played (default match-v0)")
    parser.add_argument("--seed", type=int, default=0, help="seed of all games (default 0)")
    parser.add_argument("--threads", type=int, default=1, metavar="K", help="threads to play on (default 1)")
    parser.add_argument(
        "--set", action="append", default=[], metavar="NAME=VALUE", help="a parameter in place of the default, SI units"
    )
    parser.add_argument("--effects", metavar="FILE", help="physics beyond the baseline, as `diagnose` writes it")
    parser.add_argument("--draws", metavar="FILE", help="what differs from game to game, as `diagnose` writes it")
    parser.add_argument("--json", action="store_true", help="print the result as JSON")


def parse_values(settings: Iterable[str]) -> dict[str, float]:
    """Parameters by name from texts "name=value". ValueError, in one line, for any other text."""
    values = {}
    for setting in settings:
        name, _, text = setting.partition("=")
        try:
            values[name.strip()] = float(text)
        except ValueError:
            raise ValueError(f"--set {setting}: expected NAME=NUMBER, as in friction=0.2") from None
    return values


def print_physics(args: argparse.Namespace) -> None:
    """Print the physics set by --effects, --draws and --set; nothing where none is given."""
    given = parse_values(args.set)
    for line in described(args.effects, apart_from=given) if args.effects else ():
        print(line)
    for line in draws_file.described(args.draws, apart_from=given) if args.draws else ():
        print(line)
    if given:
        print(f"set: {', '.join(f'{name} {value:.4g}' for name, value in given.items())}")


def console_for(*tables: Table) -> Console:
    """A console of at least 80 columns that is wide enough for all `tables`."""
    from rich.console import Console

    widest = max(Console(width=10_000).measure(table).maximum for table in tables)
    return Console(width=max(widest, 80), highlight=False)


@contextmanager
def progress_bar(what: str) -> Iterator[Progress]:
    """A progress bar on stderr, labelled `what`, if that is a terminal; yields the function that updates it."""
    from rich.console import Console
    from rich.markup import escape
    from rich.progress import Progress as Bar

    console = Console(stderr=True)
    with Bar(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task(escape(what), total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
