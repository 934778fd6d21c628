"""Small files that someone hands over: read strictly, each fault in one line that begins with the path.

Devices, pipes, files that are too large and tables that nest too deep are refused before they cost memory or time.
"""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

MOST_BYTES = 1 << 20  # of a text; the largest that the project writes has some ten thousand
DEEPEST = 20  # tables and lists in each other; the project's own have six


def check_regular(path: Path, most: int = MOST_BYTES) -> None:
    """ValueError for a folder, a device, a pipe, or more than `most` bytes; OSError where it cannot be looked at."""
    size = path.stat().st_size
    if not path.is_file():
        raise ValueError(f"{path}: is {'a folder' if path.is_dir() else 'a device or a pipe'}; expected a file")
    if size > most:
        raise ValueError(f"{path}: has {size:,} bytes; expected at most {most:,}")


def read_text(path: Path, most: int = MOST_BYTES) -> str:
    """The UTF-8 text of a plain file of at most `most` bytes, with or without a byte-order mark; ValueError for
    another, OSError where it cannot be read."""
    check_regular(path, most)
    try:
        return path.read_bytes().decode("utf-8-sig")
    except UnicodeDecodeError as error:
        raise ValueError(f"{path}: byte {error.start} is not UTF-8; save the file as UTF-8 text") from None


def parse_toml(text: str) -> dict[str, Any]:
    """What a TOML text holds; ValueError for one that is none, or nests too deep."""
    return _parsed(tomllib.loads, text)


def parse_json(text: str, **how: Any) -> Any:
    """The same of a JSON text; `how` goes to `json.loads`."""
    return _parsed(lambda text: json.loads(text, **how), text)


def _parsed(parse: Callable[[str], Any], text: str) -> Any:
    try:
        found = parse(text)
    except RecursionError:
        raise ValueError(f"tables or lists nest too deep; expected at most {DEEPEST} in each other") from None
    _check(found, 0)
    return found


def _check(content: Any, depth: int) -> None:
    if depth > DEEPEST:
        raise ValueError(f"tables or lists nest too deep; expected at most {DEEPEST} in each other")
    if isinstance(content, dict | list):
        for entry in content.values() if isinstance(content, dict) else content:
            _check(entry, depth + 1)
