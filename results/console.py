"""Printed answers in Markdown: a fenced block, and behind it `<!-- output: RUN -->`, or several runs in turn."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from results.marks import CODE, documents
from results.raw import Raw
from results.rows import Row

OUTPUT = re.compile(r"\n+<!--\s*output:\s*(.*?)\s*-->", re.DOTALL)
COMMAND = "$ "  # what begins a line that is typed and not printed
LEFT_OUT = "…"


@dataclass(frozen=True)
class Printed:
    """A block of a document: the runs that printed it, and its lines with their numbers, typed ones apart."""

    runs: tuple[str, ...]
    lines: tuple[tuple[int, str], ...]


def printed_blocks(text: str) -> Iterator[Printed]:
    """The blocks of a document that name the runs which printed them."""
    for block in CODE.finditer(text):
        mark = OUTPUT.match(text, block.end())
        if mark and block[1]:
            lines = enumerate(block[0].splitlines()[1:-1], text.count("\n", 0, block.start()) + 2)
            shown = tuple((number, line) for number, line in lines if line.strip() and not line.startswith(COMMAND))
            yield Printed(tuple(mark[1].split()), shown)


def wrong_printed(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line for each printed line that its runs did not print, after the one before it; `…` stands for any words."""
    known, lines = {row.id for row in rows}, []
    for path in documents(root):
        name = path.relative_to(root).as_posix()
        for block in printed_blocks(path.read_text(encoding="utf-8")):
            lines += [f"{name}:{words}" for words in _faults(block, known, raws)]
    return lines


def _faults(block: Printed, known: set[str], raws: Mapping[str, Raw]) -> Iterator[str]:
    first = block.lines[0][0] if block.lines else 0
    if not block.lines or not block.runs:
        yield f"{first}: a mark of printed lines needs a run, and lines that it printed"
        return
    for run in block.runs:
        if run not in known or run not in raws or not isinstance(raws[run].output, str):
            yield f"{first}: '{run}' is no run of results/runs.toml with a text as output"
            return
    printed = _plain("\n".join(str(raws[run].output) for run in block.runs))
    for number, line in block.lines:
        pattern = ".*?".join(re.escape(part.strip()) for part in _plain(line).split(LEFT_OUT))
        hit = re.search(pattern, printed)
        if hit is None:
            yield f"{number}: '{line.strip()}' is not printed there by {', '.join(block.runs)}"
            continue
        printed = printed[hit.end() :]


def _plain(text: str) -> str:
    return " ".join(text.split())
