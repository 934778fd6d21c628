"""JSON objects of the vision's files: read strictly, refused in one line."""

from __future__ import annotations

import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np


def read_object(path: Path, what: str) -> dict[str, Any]:
    """The object in a JSON file; `what` it should hold is said where it does not. ValueError, in one line."""
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise ValueError(f"cannot read {path}: {error.strerror or error}; expected {what}") from None
    except (ValueError, RecursionError) as error:
        raise ValueError(f"{path}: not JSON ({error}); expected {what}") from None
    if not isinstance(found, dict):
        raise ValueError(f"{path}: holds no JSON object; expected {what}")
    return found


def numbers(path: Path, holder: dict[str, Any], key: str, shape: Sequence[int]) -> np.ndarray:
    """The finite numbers of a shape under a key. ValueError, in one line, where they are not."""
    try:
        found = np.array(holder[key], dtype=float)
    except (KeyError, TypeError, ValueError):
        found = None
    if found is None or found.shape != tuple(shape) or not np.isfinite(found).all():
        size = "a number" if not shape else " by ".join(map(str, shape)) + " numbers"
        raise ValueError(f'{path}: "{key}" is {str(holder.get(key))[:60]}; expected {size}')
    return found
