"""Strict reading of the JSON files of calibrations, with errors of one line."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files import small_file

MOST_BYTES = 1 << 26  # a calibration of a table holds every point's error


def read_object(path: Path, what: str) -> dict[str, Any]:
    """Read a JSON object from a file. Raises ValueError, in one line with `what` was expected, if the file cannot be
    read, is not a JSON object, or has a key twice."""
    twice: list[str] = []

    def once(pairs: list[tuple[str, Any]]) -> dict[str, Any]:
        twice.extend(key for key, times in Counter(key for key, _ in pairs).items() if times > 1)
        return dict(pairs)

    try:
        text = small_file.read_text(path, MOST_BYTES)
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror or error}; expected {what}") from None
    try:
        found = small_file.parse_json(text, object_pairs_hook=once)
    except ValueError as error:
        raise ValueError(f"{path}: not JSON ({error}); expected {what}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path}: holds no JSON object; expected {what}")
    if twice:
        raise ValueError(f'{path}: "{twice[0][:60]}" is given twice; expected once: leave one out')
    return found


def numbers(
    path: Path, holder: dict[str, Any], key: str, shape: Sequence[int], within: tuple[float, float], unit: str = ""
) -> np.ndarray:
    """The numbers of a given shape under `key` of the object `holder`, as an array.

    within: the least and the greatest that each may be; unit: for the error text. Raises ValueError, in one line, if
    they are missing, of another shape, or out of range.
    """
    low, high = within
    try:
        found = np.array(_plain(holder.get(key)), dtype=float)
    except (TypeError, ValueError, OverflowError):
        found = None
    given = f"is {repr(holder[key])[:60]}" if key in holder else "is missing"
    if found is not None and found.shape == tuple(shape):
        far = found[~((low <= found) & (found <= high))]
        if not len(far):
            return found
        given = f"holds {far[0]:g}" if shape else given
    size = "a number" if not shape else " by ".join(map(str, shape)) + " numbers"
    raise ValueError(f'{path}: "{key}" {given}; expected {size} from {low:g} to {high:g}{unit and " " + unit}')


def _plain(found: Any) -> Any:
    """Pass nested lists of numbers. Raises TypeError for strings and booleans, which numpy would convert."""
    if isinstance(found, list):
        return [_plain(one) for one in found]
    if isinstance(found, bool) or not isinstance(found, (int, float)):
        raise TypeError
    return found
