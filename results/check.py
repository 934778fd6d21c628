"""Do the documents agree with the raw outputs, and these with the table of runs?"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from pathlib import Path

from results.console import wrong_printed
from results.marks import Mark, documents, marks
from results.page import PAGE, page
from results.provenance import in_history
from results.raw import Raw, read_raws
from results.rows import Row, read_rows
from results.unmarked import wrong_numbers
from results.values import figure_text, reaches


def problems(root: Path) -> list[str]:
    """One line for each figure, page and raw output of the repository `root` that does not agree; none if all do.

    ValueError, in one line, for a table of runs or a raw output that cannot be read.
    """
    rows, raws = read_rows(root), read_raws(root)
    checks = (wrong_outputs, wrong_marks, wrong_printed, wrong_numbers, wrong_page)
    return [line for check in checks for line in check(root, rows, raws)]


def wrong_outputs(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line for each raw output of no row, of another command, of an unknown commit, or without one of its figures."""
    by_id = {row.id: row for row in rows}
    lines = []
    for raw in raws.values():
        lines += [f"results/raw/{raw.id}.json: {words}" for words in _faults(root, by_id.get(raw.id), raw)]
    return lines


def _faults(root: Path, row: Row | None, raw: Raw) -> list[str]:
    if row is None:
        return ["belongs to no row of results/runs.toml; delete it, or add the row"]
    faults = []
    if raw.command != row.command:
        faults.append(f"is of another command, '{' '.join(raw.command)}'; {_again(raw.id)}")
    if not in_history(root, raw.commit):
        faults.append(f"its commit {raw.commit[:12]} is not in this history; {_again(raw.id)}")
    for figure in row.figures:
        try:
            figure_text(figure, raw.output)
            if figure.bar is not None:
                reaches(figure, raw.output)
        except ValueError as error:
            faults.append(f"figure {figure.name}: {error}")
    return faults


def wrong_marks(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line for each marked figure that is not what its raw output says."""
    figures = {f"{row.id}.{figure.name}": (row, figure) for row in rows for figure in row.figures}
    lines = []
    for path in documents(root):
        for mark in marks(path.read_text(encoding="utf-8")):
            if words := _disagreement(mark, figures, raws):
                lines.append(f"{path.relative_to(root).as_posix()}:{mark.line}: {words}")
    return lines


def _disagreement(mark: Mark, figures: Mapping, raws: Mapping[str, Raw]) -> str:
    if mark.name not in figures:
        return f"results/runs.toml has no figure '{mark.name}'"
    row, figure = figures[mark.name]
    if row.id not in raws:
        return f"{mark.name} has no raw output; {_again(row.id)}"
    try:
        expected = figure_text(figure, raws[row.id].output)
    except ValueError as error:
        return f"{mark.name}: {error}"
    if mark.agrees(expected):
        return ""
    return f"'{mark.found(expected)}' where {mark.name} is '{expected}'"


def wrong_page(root: Path, rows: Iterable[Row], raws: Mapping[str, Raw]) -> list[str]:
    """A line if the page is not what follows from the raw outputs."""
    path = root / PAGE
    there = path.read_text(encoding="utf-8") if path.exists() else ""
    if there == page(list(rows), raws):
        return []
    return [f"{PAGE}: does not follow from the raw outputs; python -m results page"]


def _again(id_: str) -> str:
    return f"python -m results run {id_}"
