"""Comparing what environments return, bit by bit, and finding the arrays in it."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray


def difference(a: Any, b: Any, where: str = "") -> str | None:
    """The first place where two returned values differ in type or in a bit (NaN equals NaN), in words; None if none.

    Objects that define no equality of their own are taken as equal: nothing can be said about them.
    """
    if type(a) is not type(b):
        return f"{where} is {type(a).__name__} and {type(b).__name__}"
    if isinstance(a, Mapping):
        if list(a) != list(b):
            return f"{where} has keys {list(a)} and {list(b)}"
        return _first(difference(a[key], b[key], f"{where} {key}".strip()) for key in a)
    if isinstance(a, list | tuple):
        if len(a) != len(b):
            return f"{where} has {len(a)} and {len(b)} items"
        return _first(difference(x, y, f"{where}[{i}]") for i, (x, y) in enumerate(zip(a, b, strict=True)))
    if isinstance(a, np.ndarray) and a.dtype != object:
        return _array_difference(a, b, where)
    if isinstance(a, float | np.generic):
        return None if np.asarray(a).tobytes() == np.asarray(b).tobytes() else f"{where} is {a!r} and {b!r}"
    if isinstance(a, np.ndarray):
        return difference(a.tolist(), b.tolist(), where)
    if type(a).__eq__ is object.__eq__ or a == b:
        return None
    return f"{where} is {a!r} and {b!r}"


def _first(found: Iterator[str | None]) -> str | None:
    return next((each for each in found if each is not None), None)


def _array_difference(a: NDArray[Any], b: NDArray[Any], where: str) -> str | None:
    if (a.dtype, a.shape) != (b.dtype, b.shape):
        return f"{where} is {a.dtype} {a.shape} and {b.dtype} {b.shape}"
    if a.tobytes() == b.tobytes():
        return None
    for index in np.ndindex(a.shape):
        if a[index].tobytes() != b[index].tobytes():
            return f"{where}{list(index) if index else ''} is {a[index]} and {b[index]}"
    return None


def arrays(value: Any, where: str = "") -> Iterator[tuple[str, NDArray[Any]]]:
    """Every array in a returned value, with its place in words."""
    if isinstance(value, np.ndarray):
        yield where, value
    elif isinstance(value, Mapping):
        for key, item in value.items():
            yield from arrays(item, f"{where} {key}".strip())
    elif isinstance(value, list | tuple):
        for i, item in enumerate(value):
            yield from arrays(item, f"{where}[{i}]")
