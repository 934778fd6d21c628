"""`python -m results run|page|check|screenshots`: make runs, write the page of figures, hold the documents against the
outputs, and take pictures for them.

Ends with 0, with 1 where `check` finds what does not agree, and with 2 where something could not be done.
"""

from __future__ import annotations

import argparse
import math
import sys
from collections.abc import Sequence
from pathlib import Path

from results.check import problems
from results.page import write_page
from results.rows import read_rows
from results.run import chosen, run_all
from results.screenshots import take

ROOT = Path(__file__).resolve().parents[1]


def main(words: Sequence[str] | None = None, root: Path = ROOT) -> int:
    """Do what the command line asks for in the repository `root`; return the exit status."""
    asked = _parser().parse_args(words)
    try:
        if asked.command == "run":
            rows = chosen(root, read_rows(root), asked.id, asked.minutes)
            return 2 if run_all(root, rows) else 0
        if asked.command == "page":
            print(write_page(root).relative_to(root))
            return 0
        if asked.command == "screenshots":
            print(*(file.relative_to(root) for file in take(root, asked.name)), sep="\n")
            return 0
        found = problems(root)
        print(*found, sep="\n", end="\n" if found else "")
        return 1 if found else 0
    except ValueError as error:
        print(f"results: {error}", file=sys.stderr)
    except KeyboardInterrupt:
        print("\nresults: stopped", file=sys.stderr)
    return 2


def _parser() -> argparse.ArgumentParser:
    parser = argparse.ArgumentParser(prog="python -m results", description="Published figures and where they are from.")
    commands = parser.add_subparsers(dest="command", required=True)
    run = commands.add_parser("run", help="make runs, one after the other, and keep their outputs")
    run.add_argument("id", nargs="*", help="a row of runs.toml; default: all without output, or of another command")
    run.add_argument("--minutes", type=float, default=math.inf, metavar="M", help="without ids: only rows of at most M")
    commands.add_parser("page", help="write docs/results.md from the outputs")
    pictures = commands.add_parser("screenshots", help="take pictures of the arena for the documents, in a browser")
    pictures.add_argument("name", nargs="*", help="of the picture; default: all")
    commands.add_parser("check", help="say which figure does not agree with the outputs; 1 if there is one")
    return parser


if __name__ == "__main__":
    sys.exit(main())
