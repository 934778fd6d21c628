"""Which environments there are, and the page of each."""

from __future__ import annotations

import argparse
import json


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("id", nargs="?", metavar="ID", help="print the page of this one; default: list them all")
    parser.add_argument("--json", action="store_true", help="print as JSON")
    parser.add_argument("--write-pages", action="store_true", help="write the pages in puckpilot_env/pages anew")


def run(args: argparse.Namespace) -> int:
    """0. Raises ValueError, in one line, for an unknown id."""
    if args.write_pages:
        _write_pages()
    elif args.id is not None:
        _print_page(args.id, args.json)
    elif args.json:
        from puckpilot_env.documentation.facts import describe
        from puckpilot_env.variants import all_variants

        print(json.dumps([describe(variant) for variant in all_variants().values()], indent=2))
    else:
        _print_list()
    return 0


def _write_pages() -> None:
    from puckpilot_env.documentation.page import write_pages

    files = write_pages()
    print(f"{len(files)} files written in {files[0].parent}")


def _print_page(name: str, as_json: bool) -> None:
    from rich.console import Console
    from rich.markdown import Markdown

    from puckpilot_env.documentation.facts import describe
    from puckpilot_env.documentation.page import write_page
    from puckpilot_env.variants import find_variant

    variant = find_variant(name)
    if as_json:
        print(json.dumps(describe(variant), indent=2))
    else:
        Console().print(Markdown(write_page(variant)))


def _print_list() -> None:
    from rich.console import Console
    from rich.markup import escape
    from rich.table import Table

    from puckpilot_env.documentation.facts import describe
    from puckpilot_env.variants import all_variants

    table = Table(title="Environments", title_justify="left", title_style="bold", show_lines=True)
    table.add_column("id and what it is")
    table.add_column("observed", justify="right", no_wrap=True)
    table.add_column("step", justify="right", no_wrap=True)
    table.add_column("endings", min_width=15)
    for variant in all_variants().values():
        facts = describe(variant)
        size, endings = len(facts["observation"]), "\n".join(facts["endings"])
        what = f"[cyan]{variant.id}[/cyan]\n{escape(variant.summary)}"
        table.add_row(what, str(size), f"{variant.period:g} s", endings)
    console = Console()
    console.print(table)
    console.print("observed: numbers that each player sees. The page of one: puckpilot envs ID")
