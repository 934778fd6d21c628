"""Marks of figures in Markdown: `397:0 <!-- result: RUN.FIGURE -->`."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

MARK = re.compile(r"<!--\s*result:\s*(\S+?)\s*-->")
CODE = re.compile(r"^ *(`{3,}|~{3,}).*?^ *\1|(?<!`)(`+)(?!`)(?:(?!\n\s*\n).)+?(?<!`)\2(?!`)", re.MULTILINE | re.DOTALL)
EMPHASIS = "*_` \t\n"  # what may stand between a figure and its mark
GOES_ON = re.compile(r"[\w.,+\-−]$")  # what belongs to a number that it stands before


@dataclass(frozen=True)
class Mark:
    """A mark in a document: the figure's `name` (RUN.FIGURE), its `line`, and all the text `before` it."""

    name: str
    line: int
    before: str

    def agrees(self, expected: str) -> bool:
        """Whether the text before the mark ends with the figure as expected, whatever white space is in it."""
        text, wanted = " ".join(self.before.split()), " ".join(expected.split())
        return text.endswith(wanted) and not GOES_ON.search(text[: len(text) - len(wanted)])

    def found(self, expected: str) -> str:
        """What stands before the mark: as many words as are expected there."""
        return " ".join(self.before.split()[-max(len(expected.split()), 1) :]).strip(EMPHASIS)


def documents(root: Path) -> list[Path]:
    """The documents whose marks are checked: README.md and all of docs/."""
    return [path for path in (root / "README.md", *sorted((root / "docs").rglob("*.md"))) if path.exists()]


def marks(text: str) -> Iterator[Mark]:
    """The marks of a document, but for those in code."""
    code = [hit.span() for hit in CODE.finditer(text)]
    for hit in MARK.finditer(text):
        if not any(start <= hit.start() < end for start, end in code):
            before = text[: hit.start()].rstrip(EMPHASIS)
            yield Mark(hit[1], text.count("\n", 0, hit.start()) + 1, before)
