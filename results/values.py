"""Figures as text, taken of the output of a run.

An expression is one pointer, or several pointers and numbers with ` * ` or ` / ` between them, taken from left to
right. A pointer is a JSON pointer (RFC 6901), `/wins/0`; of a list its word `name=value` stands for the one item with
that entry, and `length` for the number of items.
"""

from __future__ import annotations

import re
from typing import Any

from results.rows import Figure


def figure_text(figure: Figure, output: Any) -> str:
    """The figure as it is published. ValueError where the output does not hold it."""
    values = _groups(figure.find, output) if figure.find else [value(one, output, figure.at) for one in figure.values]
    try:
        return figure.show.format(*values)
    except (ValueError, TypeError, IndexError) as error:
        raise ValueError(f"{figure.show!r} cannot show {values}: {error}") from None


def reaches(figure: Figure, output: Any) -> bool:
    """Whether a figure with a bar reaches it. ValueError where there is nothing to compare."""
    assert figure.bar is not None
    if figure.find:
        found = _groups(figure.find, output)[0]
    else:
        found = value(figure.bar.of or figure.values[0], output, figure.at)
    if not isinstance(found, int | float):
        raise ValueError(f"a bar needs a number, and {figure.name} has {found!r}")
    return figure.bar.least <= found <= figure.bar.most


def value(expression: str, output: Any, at: str = "") -> Any:
    """What an expression is for a JSON output; pointers that begin with no slash begin at the pointer `at`."""
    first, *rest = re.split(r" ([*/]) ", expression)
    found = _operand(first, output, at)
    for sign, word in zip(rest[::2], rest[1::2], strict=True):
        factor = _operand(word, output, at)
        if not all(isinstance(one, int | float) for one in (found, factor)) or (sign == "/" and factor == 0):
            raise ValueError(f"'{expression}' asks for {found!r} {sign} {factor!r}")
        found = found * factor if sign == "*" else found / factor
    return found


def _operand(word: str, output: Any, at: str) -> Any:
    try:
        return float(word)
    except ValueError:
        return at_pointer(word if word.startswith("/") else f"{at}/{word}", output)


def at_pointer(pointer: str, output: Any) -> Any:
    """What is at a pointer. ValueError, which names the first word that leads nowhere."""
    found = output
    for word in pointer.split("/")[1:]:
        found = _step(found, word.replace("~1", "/").replace("~0", "~"), pointer)
    return found


def _step(found: Any, word: str, pointer: str) -> Any:
    if isinstance(found, dict) and word in found:
        return found[word]
    if isinstance(found, list):
        if word.isdecimal() and int(word) < len(found):
            return found[int(word)]
        if word == "length":
            return len(found)
        name, sign, wanted = word.partition("=")
        fitting = [item for item in found if isinstance(item, dict) and sign and str(item.get(name)) == wanted]
        if len(fitting) == 1:
            return fitting[0]
    raise ValueError(f"the output has no '{pointer}': '{word}' leads nowhere, or to several")


def _groups(find: str, output: Any) -> list[Any]:
    """What the groups of a regular expression hold, as numbers where they are numbers."""
    hit = re.search(find, output if isinstance(output, str) else "", re.MULTILINE)
    if hit is None or not hit.groups():
        raise ValueError(f"the output has nothing like {find!r}, or that has no group")
    return [_number(group) for group in hit.groups("")]


def _number(text: str) -> int | float | str:
    for kind in (int, float):
        try:
            return kind(text.replace(",", ""))
        except ValueError:
            continue
    return text
