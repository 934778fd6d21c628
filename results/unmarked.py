"""Numbers with a unit in the documents that no run made: figures without a mark, or stated in `stated.toml`."""

from __future__ import annotations

import re
from collections.abc import Iterable, Mapping
from contextlib import suppress
from pathlib import Path
from typing import Any

from puckpilot_env.files.toml_file import check_format, read_toml
from results.marks import CODE, documents, marks
from results.page import PAGE
from results.raw import Raw
from results.rows import Row
from results.values import figure_text

FORMAT = "puckpilot-stated/1"
STATED = "results/stated.toml"
UNITS = (
    "%", "×", "m", "m/s", "mm/s", "mm", "cm", "µm", "um", "ms", "µs", "us", "ns", "s", "min", "minutes?", "hours?",
    "times", "Hz", "kHz", "rad", "°", "A", "V", "W", "bits?", "bytes", "kB", "MB", "GB", "instructions", "million",
    "thousand", "billion", "M", "k", "px", "pixels?",
)  # fmt: skip
VALUE = r"[−-]?\d[\d,.]*(?:\^\d+)?"
NUMBER = re.compile(
    rf"(?<![\w.,^`-])(?:{VALUE}(?:\s(?:to|and|or)\s|,\s|[–-]))*{VALUE}\s?(?:{'|'.join(UNITS)})(?![\w/])"
    rf"|(?<![\w.,])\d[\d,.]*\s(?:of|in)\s\d[\d,.^]*|\d[\d,.]* (?:agent-)?steps/s"
)
COMMENT = re.compile(r"<!--.*?-->", re.DOTALL)


def wrong_numbers(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line for each number with a unit that is neither a marked figure nor stated, and for what is stated in vain.

    ValueError, in one line, for a table of stated numbers that cannot be read.
    """
    stated, figures, lines = read_stated(root), _figure_texts(rows, raws), []
    for path in documents(root):
        name = path.relative_to(root).as_posix()
        if name == PAGE:
            continue
        left = set(stated.pop(name, ()))
        unused = set(left)
        for line, number in numbers(path.read_text(encoding="utf-8"), figures):
            unused.discard(number)
            if number not in left:
                lines.append(f"{name}:{line}: '{number}' has no mark; mark it, or state it in {STATED}")
        lines += [f"{STATED}: '{number}' is stated of {name}, which has no such number" for number in sorted(unused)]
    return lines + [f"{STATED}: {name} is no document" for name in stated]


def numbers(text: str, figures: Mapping[str, str]) -> list[tuple[int, str]]:
    """The numbers with a unit of a document, and their lines: none in code, and none that a mark's figure holds.

    `figures`: the text of each figure by its name, RUN.FIGURE.
    """
    kept = list(text)
    for hit in [*CODE.finditer(text), *COMMENT.finditer(text)]:
        _blank(kept, *hit.span())
    for mark in marks(text):
        end, length = len(mark.before), len(figures.get(mark.name, ""))
        _blank(kept, end - length, end)
    plain = "".join(kept)
    return [(plain.count("\n", 0, hit.start()) + 1, " ".join(hit[0].split())) for hit in NUMBER.finditer(plain)]


def _blank(characters: list[str], start: int, end: int) -> None:
    for k in range(max(start, 0), end):
        if characters[k] != "\n":
            characters[k] = "|"


def _figure_texts(rows: Iterable[Row], raws: Mapping[str, Raw]) -> dict[str, str]:
    texts = {}
    for row in rows:
        for figure in row.figures:
            if row.id in raws:
                with suppress(ValueError):  # `wrong_outputs` reports it
                    texts[f"{row.id}.{figure.name}"] = figure_text(figure, raws[row.id].output)
    return texts


def read_stated(root: Path) -> dict[str, list[str]]:
    """What is stated of each document; none without such a table. ValueError, in one line, for a fault."""
    path = root / STATED
    if not path.exists():
        return {}
    return read_toml(path, "the table of stated numbers", STATED, f'format = "{FORMAT}"', _lists)


def _lists(content: Mapping[str, Any]) -> dict[str, list[str]]:
    check_format(content, FORMAT, tuple(content))
    lists = {name: value for name, value in content.items() if name != "format"}
    for name, value in lists.items():
        if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
            raise ValueError(f"'{name}' is no list of texts")
    return lists
