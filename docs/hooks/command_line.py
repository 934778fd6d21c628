"""MkDocs hook: the page of the command line, written from the table of commands and their parsers."""

from __future__ import annotations

import argparse
import importlib
import re
import textwrap

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

import puckpilot

PAGE = "reference/commands.md"
HEAD = """\
# Command line

Written from the parsers of the commands themselves.

A command ends with 0 when it did what was asked, with 1 when it did and the answer is bad news, and with 2 when it
could not; then one line says why. `puckpilot COMMAND --help` prints what stands here.

| command | what it does |
| --- | --- |
"""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add the page."""
    files.append(File.generated(config, PAGE, content=write_page()))
    return files


def write_page() -> str:
    """All commands: an overview, then a section each."""
    rows = "".join(
        f"| [`{name}`](#{_anchor(name)}) | {_cell(what)} |\n" for name, (_, what) in puckpilot.COMMANDS.items()
    )
    return HEAD + rows + "".join(_section(name) for name in puckpilot.COMMANDS)


def _section(name: str) -> str:
    module = importlib.import_module(puckpilot.COMMANDS[name][0])
    parser = argparse.ArgumentParser(prog=f"puckpilot {name}", add_help=False)
    module.add_arguments(parser)
    prose = (module.__doc__ or puckpilot.COMMANDS[name][1]).strip().replace("<", "&lt;")
    return f"\n## {name} {{#{_anchor(name)}}}\n\n{prose}\n\n{_usage(parser)}{_arguments(parser)}"


def _usage(parser: argparse.ArgumentParser) -> str:
    words = " ".join(parser.format_usage().removeprefix("usage: ").split())
    lines = textwrap.wrap(words, 76, subsequent_indent="    ", break_on_hyphens=False)
    return "```text\n" + "\n".join(lines) + "\n```\n"


def _arguments(parser: argparse.ArgumentParser) -> str:
    formatter = argparse.HelpFormatter(parser.prog)
    rows = [
        f"| `{_cell(formatter._format_action_invocation(action))}` | {_cell(formatter._expand_help(action))} |\n"
        for action in parser._actions
        if action.help is not argparse.SUPPRESS
    ]
    return "\n| argument | meaning |\n| --- | --- |\n" + "".join(rows) if rows else ""


def _anchor(name: str) -> str:
    return name.replace(" ", "-")


def _cell(text: str) -> str:
    return re.sub(r"\s+", " ", text).replace("|", "\\|").replace("<", "&lt;")
