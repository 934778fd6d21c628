"""What a caller hands over, looked at before anything is done with it: each refusal says in one line what was given
and what was expected."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

LONGEST = 60  # characters, of a given value in a message

Index = slice | NDArray[np.integer]


def in_short(given: object) -> str:
    """`given` as Python writes it, on one line and not too long."""
    try:
        words = " ".join(repr(given.item() if isinstance(given, np.generic) else given).split())
    except Exception:  # a whole number of thousands of digits, or another's own repr
        words = f"a {type(given).__name__}"
    return words if len(words) <= LONGEST else f"{words[: LONGEST - 4]} ..."


def whole_number(given: object, name: str, low: int, high: int, most: str = "") -> int:
    """`given` as an int from `low` to `high` (`most`: words for it). ValueError for another and for a truth value."""
    if not isinstance(given, int | np.integer) or isinstance(given, bool) or not low <= given <= high:
        raise ValueError(f"{name} is {in_short(given)}; expected a whole number from {low} to {most or f'{high:,}'}")
    return int(given)


def seed_number(given: object) -> int:
    """`given` as a seed of random streams."""
    return whole_number(given, "seed", 0, 2**64 - 1, "2**64 - 1")


def real_number(given: object) -> float:
    """`given` as a float; NaN for what is no real number, or too large for one. A text or a truth value is none."""
    if not isinstance(given, int | float | np.integer | np.floating) or isinstance(given, bool):
        return math.nan
    try:
        return float(given)
    except OverflowError:
        return math.nan


def truth(given: object, name: str) -> bool:
    """`given` as a bool; ValueError for what only counts as one."""
    if not isinstance(given, bool | np.bool_):
        raise ValueError(f"{name} is {in_short(given)}; expected True or False")
    return bool(given)


def one_of(given: object, name: str, *choices: int | str | None) -> Any:
    """`given` if it is one of `choices`; ValueError if not. No truth value counts as 0 or 1."""
    plain = int(given) if isinstance(given, np.integer) else given
    if isinstance(plain, int | str | None) and not isinstance(plain, bool) and plain in choices:
        return plain
    *others, last = (repr(choice) for choice in choices)
    raise ValueError(f"{name} is {in_short(given)}; expected {', '.join(others)} or {last}")


def by_name(given: object, name: str, example: str) -> dict[Any, Any]:
    """`given`, a mapping or None, as a dict; ValueError for anything else."""
    if given is None:
        return {}
    if not isinstance(given, Mapping):
        raise ValueError(f"{name} is {in_short(given)}; expected a dict, as in {example}")
    return dict(given)


def reset_options(given: object) -> dict[Any, Any]:
    """The `options` of a reset as a dict."""
    return by_name(given, "options", "reset(seed=1, options={}), or None")


def table_index(given: object, tables: int) -> Index:
    """An index of some of so many tables that keeps the first axis: a number stands for a list of one.

    given: a slice, a number, numbers or a mask of all tables. ValueError for what names no table, or one twice.
    """
    if isinstance(given, slice):
        try:
            given.indices(tables)
        except (TypeError, ValueError):
            raise ValueError(f"tables is {in_short(given)}; expected a slice of whole numbers") from None
        return given
    try:
        index = np.atleast_1d(np.asarray(given))
    except ValueError:  # a ragged list
        index = np.empty(0, object)
    if index.dtype == np.bool_ and index.shape == (tables,):
        return np.flatnonzero(index)
    if index.size == 0 and index.ndim == 1 and index.dtype != np.object_:
        return np.zeros(0, np.intp)
    if index.ndim != 1 or index.dtype.kind not in "iu" or not np.all((index >= -tables) & (index < tables)):
        raise ValueError(f"tables is {in_short(given)}; expected a slice, a mask or indices of {tables} tables")
    if len(np.unique(index % tables)) < len(index):
        raise ValueError(f"tables is {in_short(given)}; expected each table once")
    return index
