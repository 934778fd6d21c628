"""Does an environment keep its promises? Each finding is a fact, what it means, and what to do.

With --adversarial it plays so many steps of tables at the ends of their ranges, with none, one, two or many effects,
against players that pin, press and hit the puck, and holds each step against what no game may break: numbers are
finite, the puck is inside and in no mallet, mallets keep to their areas, no energy comes from nowhere, and the slowest
step takes no more than 200 times what half of them take. What breaks is printed with the command that shows it again.
"""

from __future__ import annotations

import argparse
import dataclasses
import json
from typing import Any

STYLES = {"passed": "green", "error": "bold red", "warning": "yellow", "info": "cyan"}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("ids", nargs="*", metavar="ID|module:attribute", help="environments; default: all of puckpilot")
    parser.add_argument("--steps", type=int, default=2000, help="steps that each check plays (default 2000, a match)")
    parser.add_argument("--seed", type=int, default=0, help="seed of the games (default 0)")
    parser.add_argument(
        "--adversarial", type=int, metavar="STEPS", help="play at least so many steps at the ends of all ranges instead"
    )
    parser.add_argument("--json", action="store_true", help="print findings as JSON")


def run(args: argparse.Namespace) -> int:
    """0 if all checks passed, 1 if an environment failed one. Raises ValueError, in one line, where it cannot check."""
    if args.adversarial is not None:
        return _run_adversarial(args.ids, args.adversarial, args.seed, args.json)
    from puckpilot_env.checks.runner import find_maker
    from puckpilot_env.variants import all_variants

    names = args.ids or list(all_variants())
    for name in names:
        find_maker(name)  # so that a misspelt last one is refused before the others are played
    found = _check_all(names, args.steps, args.seed)
    if args.json:
        print(json.dumps([{"id": name, "checks": _as_dicts(results)} for name, results in found.items()], indent=2))
    else:
        _print_tables(found)
    return int(any(result.failed for results in found.values() for result in results))


def _run_adversarial(ids: list[str], steps: int, seed: int, as_json: bool) -> int:
    """0 if nothing broke and no step took too long, else 1."""
    from rich.console import Console
    from rich.progress import Progress

    from puckpilot_env.checks.adversarial.play import MOST_MEDIANS, Found
    from puckpilot_env.checks.adversarial.worker import play_many
    from puckpilot_env.variants import all_variants, find_variant

    if steps < 1:
        raise ValueError(f"--adversarial is {steps}; expected a number of steps, at least 1")
    if seed < 0:
        raise ValueError(f"--seed is {seed}; expected a whole number, at least 0")
    names = [find_variant(name).id for name in ids] or list(all_variants())
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("playing", total=steps)

        def show(batch: Found) -> None:
            bar.update(task, advance=batch.steps)
            for breach in () if as_json else batch.breaches:
                print(breach, flush=True)

        found = play_many(names, steps, seed, show)
    ratio = found.slowest.seconds / found.median
    if as_json:
        slowest = {**dataclasses.asdict(found.slowest), "medians": ratio}
        report = {"steps": found.steps, "median_s": found.median, "slowest": slowest}
        print(json.dumps({**report, "breaches": [dataclasses.asdict(each) for each in found.breaches]}, indent=2))
    else:
        print(f"{found.steps:,} steps, {len(found.breaches)} broke a rule")
        print(f"a step takes {1e6 * found.median:.3g} us (median), the slowest {1e6 * found.slowest.seconds:.4g} us,")
        print(f"{ratio:.3g} times that (at most {MOST_MEDIANS:g}): {found.slowest}")
        if ratio > MOST_MEDIANS:
            print("failed: the slowest step takes too long")
    return int(bool(found.breaches) or ratio > MOST_MEDIANS)


def _check_all(names: list[str], steps: int, seed: int) -> dict[str, list[Any]]:
    from rich.console import Console
    from rich.progress import Progress

    from puckpilot_env.check import check_names, run_checks

    found = {}
    console = Console(stderr=True)
    with Progress(console=console, transient=True, disable=not console.is_terminal) as bar:
        task = bar.add_task("checking", total=len(names) * len(check_names()))

        for name in names:

            def show(check: str, name: str = name) -> None:
                bar.update(task, advance=1, description=f"{name}: {check}")

            found[name] = run_checks(name, steps=steps, seed=seed, progress=show)
    return found


def _as_dicts(results: list[Any]) -> list[dict[str, Any]]:
    return [dataclasses.asdict(result) for result in results]


def _print_tables(found: dict[str, list[Any]]) -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    console = Console()
    for name, results in found.items():
        table = Table(title=name, title_justify="left", title_style="bold", expand=False)
        for heading in ("check", "finding", "fact, what it means, what to do"):
            table.add_column(heading, overflow="fold")
        for result in results:
            verdict = "passed" if result.passed else result.level
            words = [result.detail] if result.passed else [result.detail, result.meaning, result.remedy]
            style = STYLES[verdict]
            table.add_row(result.name, f"[{style}]{verdict}[/{style}]", escape("\n".join(words)))
        console.print(table)
        failed = sum(result.failed for result in results)
        passed = sum(result.passed for result in results)
        console.print(f"{passed} of {len(results)} passed, {failed} failed\n")
