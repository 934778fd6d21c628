"""Pieces of HTML: escaped text, numbers, tables, pictures."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from html import escape

from sim2real.diagnose.finding import Estimate
from sim2real.diagnose.plain_words import digits_of, unit_words


def text(words: object) -> str:
    """Anything as text that no browser takes for markup."""
    return escape(str(words), quote=True)


def number(value: float) -> str:
    """A number to four digits."""
    return f"{value:.4g}"


def estimate_cells(name: str, one: Estimate) -> list[str]:
    """The cells of a row: name, value, 95 % interval, unit."""
    value, low, high = digits_of(one)
    return [text(name), value, f"{low} … {high}", text(unit_words(one.unit))]


def table(caption: str, head: Sequence[str], rows: Iterable[Sequence[str]], numeric: Sequence[int] = ()) -> str:
    """A table whose cells are HTML; the first cell of a row names it, the columns `numeric` are numbers."""
    kinds = ['class="n"' if k in numeric else "" for k in range(len(head))]
    top = "".join(f'<th scope="col" {kind}>{cell}</th>' for cell, kind in zip(head, kinds, strict=True))
    body = "".join(
        f'<tr><th scope="row">{row[0]}</th>'
        + "".join(f"<td {kind}>{cell}</td>" for cell, kind in zip(row[1:], kinds[1:], strict=True))
        + "</tr>"
        for row in rows
    )
    return (
        f'<div class="scroll"><table><caption>{caption}</caption><thead><tr>{top}</tr></thead>'
        f"<tbody>{body}</tbody></table></div>"
    )


def estimates(caption: str, some: Iterable[tuple[str, Estimate]]) -> str:
    """A table of fitted numbers."""
    rows = [estimate_cells(name, one) for name, one in some]
    return table(caption, ("parameter", "value", "95 % interval", "unit"), rows, (1, 2))


def folded(summary: str, body: str) -> str:
    """What is shown when one asks for it."""
    return f"<details><summary>{summary}</summary>{body}</details>"


def picture(svg: str, caption: str, kind: str = "") -> str:
    """An inline picture with its caption."""
    return f'<figure class="{kind}">{svg}<figcaption>{caption}</figcaption></figure>'


def section(name: str, title: str, body: str) -> str:
    """A section of the page that can be pointed at."""
    return f'<section id="{text(name)}"><h2>{title}</h2>{body}</section>\n'


def paragraph(body: str) -> str:
    """A paragraph; nothing where there is nothing to say."""
    return f"<p>{body}</p>" if body else ""
