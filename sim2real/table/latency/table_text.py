"""Parts of the delay as an aligned table, and as lines for a table's file."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

from sim2real.table.latency.part import Part
from sim2real.table.physical.table_file import LATENCY


def table_lines(parts: Sequence[Part], injected: Mapping[str, float] | None = None) -> list[str]:
    """A line for each part: value, interval, from what to what, by what; `injected`: what is true of a twin."""
    head = ["part", "value", "95 % interval", *(["injected"] if injected else []), "what", "by"]
    rows = [head] + [_row(one, injected) for one in parts if one.determined]
    widths = [max(len(row[k]) for row in rows) for k in range(len(head) - 1)]
    if len(rows) == 1:
        rows = []
    lines = ["  ".join([*(f"{cell:{w}}" for cell, w in zip(row, widths, strict=False)), row[-1]]) for row in rows]
    return lines + [f"{one.name}: not determined, because {one.why}" for one in parts if not one.determined]


def _row(one: Part, injected: Mapping[str, float] | None) -> list[str]:
    assert one.value is not None and one.low is not None and one.high is not None
    size, unit, digits = (1e3, "ms", 2) if one.unit == "s" else (1.0, one.unit, 1)
    shown = [f"{size * number:.{digits}f}" for number in (one.value, one.low, one.high)]
    known = injected or {}
    true = [f"{size * known[one.name]:.{digits}f}" if one.name in known else ""] if injected else []
    return [one.name, f"{shown[0]} {unit}", f"{shown[1]} to {shown[2]}", *true, one.what, one.by]


def toml_lines(parts: Sequence[Part], stated: float | None = None) -> list[str]:
    """The section [latency] for a table's file: what is determined, in s and ppm; none without.

    stated: the delay that stamps of frames were already corrected by [s], to which the camera's is added; None if that
    is not known.
    """
    if not any(one.determined and one.name in LATENCY for one in parts):
        return []
    found = {one.name: one for one in parts if one.determined}
    digits = {"s": 6, "ppm": 1}
    camera = found["camera"].value if "camera" in found else None
    delay = [] if stated is None or camera is None else [f"delay = {max(stated + camera, 0.0):.6f}  # s"]
    return ["[latency]", *delay] + [
        f"{name} = {found[name].value:.{digits[found[name].unit]}f}  # {found[name].unit}"
        for name in LATENCY
        if name in found
    ]
