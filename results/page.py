"""The page of all published figures, made of the raw outputs alone."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from results.raw import Raw, read_raws
from results.rows import Figure, Row, read_rows
from results.values import figure_text, reaches

PAGE = "docs/results.md"
HEAD = """# Results

Every published figure, taken of the output of a command that is kept in `results/raw/`. `python -m results page` makes
this page, `python -m results run NAME` makes a run again, and `python -m results check` says which figure of the README
or of these pages is another than in its output. The name of a figure is RUN.FIGURE. Commands are run in a clone of the
repository, with one thread of linear algebra; `../shared` is a folder of recordings beside it.
"""


def write_page(root: Path) -> Path:
    """Write the page of the repository `root`, and return its path. ValueError for raw outputs that cannot be read."""
    path = root / PAGE
    path.parent.mkdir(exist_ok=True)
    return write_text_whole(path, page(read_rows(root), read_raws(root)))


def page(rows: Sequence[Row], raws: Mapping[str, Raw]) -> str:
    """The page as Markdown: of each topic a table of figures and one of runs, and the machines in the end."""
    made = [row for row in rows if row.id in raws]
    machines: list[dict[str, Any]] = []
    for row in made:
        if raws[row.id].machine not in machines:
            machines.append(raws[row.id].machine)
    parts = [HEAD]
    for topic in dict.fromkeys(row.topic for row in made):
        parts.append(_topic(topic, [row for row in made if row.topic == topic], raws, machines))
    parts.append(_machines(machines))
    return "\n".join(parts)


def _topic(topic: str, rows: Sequence[Row], raws: Mapping[str, Raw], machines: list) -> str:
    figures = [_figure_line(row, figure, raws[row.id]) for row in rows for figure in row.figures]
    runs = [_run_line(row, raws[row.id], machines.index(raws[row.id].machine) + 1) for row in rows]
    return (
        f"## {topic}\n\n"
        + _table("what | figure | bar | name", figures)
        + "\n"
        + _table("run | command | seed | commit | date | took | machine", runs)
    )


def _figure_line(row: Row, figure: Figure, raw: Raw) -> list[str]:
    try:
        text, bar = figure_text(figure, raw.output), _bar(figure, raw)
    except ValueError:
        text, bar = "not in the output", ""
    return [f"{row.title}: {figure.what}", text, bar, f"`{row.id}.{figure.name}`"]


def _bar(figure: Figure, raw: Raw) -> str:
    if figure.bar is None:
        return ""
    return f"{figure.bar.words}: {'reached' if reaches(figure, raw.output) else 'missed'}"


def _run_line(row: Row, raw: Raw, machine: int) -> list[str]:
    seed = "" if raw.seed is None else str(raw.seed)
    took = f"{raw.seconds:.0f} s" if raw.seconds < 100 else f"{raw.seconds / 60:.0f} min"
    return [row.id, f"`{' '.join(raw.command)}`", seed, f"`{raw.commit[:9]}`", raw.date[:10], took, str(machine)]


def _machines(machines: list[dict[str, Any]]) -> str:
    lines = [
        f"{number}. {one['cpu']}, {one['cores']} cores, {one['system']}; "
        + ", ".join(f"{name} {one[name]}" for name in one if name not in ("cpu", "cores", "system"))
        for number, one in enumerate(machines, 1)
    ]
    return "\n".join(["## Machines\n", *lines, ""])


def _table(head: str, lines: list[list[str]]) -> str:
    rule = " | ".join("---" for _ in head.split(" | "))
    rows = [" | ".join(cell.replace("|", "\\|") for cell in line) for line in lines]
    return "".join(f"| {row} |\n" for row in (head, rule, *rows))
