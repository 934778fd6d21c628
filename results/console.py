"""Printed answers in Markdown: a fenced block, and behind it `<!-- output: RUN -->`, or several runs in turn."""

from __future__ import annotations

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from itertools import takewhile
from pathlib import Path

from results.marks import CODE, documents
from results.raw import Raw
from results.rows import Row

OUTPUT = re.compile(r"\n+<!--\s*output:\s*(.*?)\s*-->", re.DOTALL)
COMMAND = "$ "  # what begins a line that is typed and not printed
LEFT_OUT = "[…]"


@dataclass(frozen=True)
class Printed:
    """A block of a document from a `line` on: the runs that printed it, and its lines with their numbers."""

    line: int
    runs: tuple[str, ...]
    typed: tuple[tuple[int, str], ...]
    printed: tuple[tuple[int, str], ...]


def printed_blocks(text: str) -> Iterator[Printed]:
    """The blocks of a document that name the runs which printed them."""
    for block in CODE.finditer(text):
        mark = OUTPUT.match(text, block.end())
        if mark and block[1]:
            first = text.count("\n", 0, block.start()) + 1
            lines = [one for one in enumerate(block[0].splitlines()[1:-1], first + 1) if one[1].strip()]
            typed = tuple((number, line[len(COMMAND) :]) for number, line in lines if line.startswith(COMMAND))
            printed = tuple(one for one in lines if not one[1].startswith(COMMAND))
            yield Printed(first, tuple(mark[1].split()), typed, printed)


def wrong_printed(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line for each printed line that its runs did not print, after the one before it, and for each mark without a
    block. `[…]` stands for any words of a line."""
    by_id, lines = {row.id: row for row in rows}, []
    for path in documents(root):
        name, text = path.relative_to(root).as_posix(), path.read_text(encoding="utf-8")
        blocks = list(printed_blocks(text))
        for block in blocks:
            lines += [f"{name}:{words}" for words in _faults(block, by_id, raws)]
        if (marks := len(OUTPUT.findall(CODE.sub("", text)))) > len(blocks):
            lines.append(f"{name}: {marks - len(blocks)} of its marks of printed lines follow no block of ``` or ~~~")
    return lines


def _faults(block: Printed, by_id: Mapping[str, Row], raws: Mapping[str, Raw]) -> Iterator[str]:
    if not block.printed or not block.runs:
        yield f"{block.line}: a mark of printed lines needs a run, and lines that it printed"
        return
    for run in block.runs:
        if run not in by_id or run not in raws or not isinstance(raws[run].output, str):
            yield f"{block.line}: '{run}' is no run of results/runs.toml with a text as output"
            return
    if block.typed:
        commands = [" ".join(_before_options(by_id[run].command)) for run in block.runs]
        for number, words in block.typed:
            if not any(" ".join(_before_options(words.split())) == command for command in commands):
                yield f"{number}: '$ {words}' is not the command of {', '.join(block.runs)}"
    printed = [_plain(line) for run in block.runs for line in str(raws[run].output).splitlines()]
    for number, line in block.printed:
        parts = (re.escape(part.strip()) for part in _plain(line).split(LEFT_OUT))
        pattern = re.compile(r"(?<!\S)" + ".*?".join(parts) + r"(?!\S)")
        at = next((k for k, one in enumerate(printed) if pattern.search(one)), None)
        if at is None:
            yield f"{number}: '{line.strip()}' is not printed there by {', '.join(block.runs)}"
        else:
            hit = pattern.search(printed[at])
            printed = [printed[at][hit.end() if hit else 0 :], *printed[at + 1 :]]


def _before_options(words: Sequence[str]) -> list[str]:
    """The words of a command before its first option."""
    return list(takewhile(lambda word: not word.startswith(("-", "#")), words))


def _plain(text: str) -> str:
    return " ".join(text.split())
