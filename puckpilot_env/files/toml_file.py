"""Files of numbers by name that a person may write: read strictly, each fault in one line that begins with the path."""

from __future__ import annotations

import difflib
import tomllib
from collections.abc import Callable, Iterable, Mapping
from os import PathLike
from pathlib import Path
from typing import Any, TypeVar

from puckpilot_env.files import small_file
from puckpilot_env.options.inputs import in_short

Content = TypeVar("Content")


def read_toml(
    path: str | PathLike[str], what: str, expected: str, example: str, read: Callable[[Mapping[str, Any]], Content]
) -> Content:
    """What `read` makes of a TOML file. `what` the file holds, which one is `expected`, and an `example` of its lines
    are words for the errors.

    Raises ValueError, in one line, for a file that is not there or not TOML, and for what `read` raises it for.
    """
    path = Path(path)
    try:
        text = small_file.read_text(path)
    except OSError as error:
        words = f"cannot read {what} from '{path}': {error.strerror or error}"
        raise ValueError(f"{words}; expected a file such as {expected}") from None
    try:
        return read(small_file.parse_toml(text))
    except tomllib.TOMLDecodeError as error:
        raise ValueError(f"{path}: not a TOML file ({error}); expected lines like {example}") from None
    except ValueError as error:
        raise ValueError(f"{path}: {' '.join(str(error).split())}") from None


def check_format(content: Mapping[str, Any], expected: str, entries: Iterable[str]) -> None:
    """ValueError for content of another format, or with an entry beside `format` and `entries`."""
    if content.get("format") != expected:
        said = f"format is {in_short(content['format'])}" if "format" in content else "there is no line with its format"
        raise ValueError(f'{said}; expected the line format = "{expected}"')
    refuse_unknown(content, ("format", *entries), "entry")


def section(content: Mapping[str, Any], name: str, where: str = "") -> Mapping[str, Any]:
    """A table of the content, empty if there is none. ValueError for what is no table."""
    found = content.get(name, {})
    if not isinstance(found, Mapping):
        raise ValueError(f"{where + '.' if where else ''}{name} is {in_short(found)}; expected numbers by name")
    return found


def refuse_unknown(given: Iterable[str], known: Iterable[str], what: str) -> None:
    """ValueError for the first name that is not known, with the nearest that is."""
    known = list(known)
    for name in given:
        if name not in known:
            near = difflib.get_close_matches(str(name), known, n=1)
            hint = f"did you mean '{near[0]}'?" if near else f"known: {', '.join(known)}"
            raise ValueError(f"unknown {what} '{name}'; {hint}")
