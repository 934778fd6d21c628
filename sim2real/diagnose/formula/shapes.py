"""Functional forms of one-line formulas.

A profile is a scalar function of one coordinate. A form is a law with c components at n instants or contacts, such as
an acceleration in the plane: a profile along one or more directions. Both are linear in their amplitudes; their other
parameters are nonlinear.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from itertools import product

import numpy as np

from sim2real.diagnose.formula.tuned import FORMULA

Named = dict[str, tuple[float, str]]  # name: value and unit
PARAMETERS = ("slope", "size", "decay", "middle", "width", "wave", "shift", "toward", "offset")
COMMON = ("decay", "middle", "width", "wave")  # nonlinear parameters, common to all directions


@dataclass(frozen=True)
class Axis:
    """A coordinate: its `name` in a formula, its `unit`, its `values` (n,), nan where unknown, and whether laws of it
    have an `offset`, a constant beside the profile."""

    name: str
    unit: str
    values: np.ndarray
    offset: bool = False


@dataclass(frozen=True)
class Direction:
    """The direction of a law: `vectors` (n, c) of one unit of it at each instant or contact.

    `law`: the letter of the law in a formula; `symbol`: its index; `words`: the direction at the end of a formula.
    """

    law: str
    symbol: str
    words: str
    vectors: np.ndarray


@dataclass(frozen=True)
class Form:
    """A law of named parameters: q nonlinear ones and k amplitudes.

    `basis(nonlinear)`: the law (n, c, k) per amplitude; `grid` (g, q): where to search for the nonlinear parameters;
    `named(nonlinear, amplitude)`: both as values with units, by name; `field(values)`: the law (n, c) of such values;
    `words(values)`: its formula.
    """

    name: str
    grid: np.ndarray
    basis: Callable[[np.ndarray], np.ndarray]
    named: Callable[[np.ndarray, np.ndarray], Named]
    field: Callable[[Mapping[str, float]], np.ndarray]
    words: Callable[[Mapping[str, float]], str]


@dataclass(frozen=True)
class Profile:
    """A function of one coordinate `u` (n,), of q nonlinear parameters and m amplitudes.

    `grid` (g, q): where to search for the nonlinear parameters; `columns(u, nonlinear)`: the function (n, m) per
    amplitude; `named(nonlinear, amplitude)`: both as values with units, by name; `value(u, values)` (n,): the function
    of such values; `words(name, values)`: its formula in a coordinate of this name.
    """

    name: str
    grid: np.ndarray
    columns: Callable[[np.ndarray, np.ndarray], np.ndarray]
    named: Callable[[np.ndarray, np.ndarray], Named]
    value: Callable[[np.ndarray, Mapping[str, float]], np.ndarray]
    words: Callable[[str, Mapping[str, float]], str]


def profiles(axis: Axis, unit: str) -> list[Profile]:
    """Return the functions of a coordinate for formulas, with sizes in `unit`.

    They are powers, a decay, a bump, a stripe and a sine.
    """
    u = axis.values[np.isfinite(axis.values)]
    low, high = float(u.min()), float(u.max())
    return [
        *_powers(axis, unit),
        *_local(axis, unit, low, high),
        sine(axis, unit, (high - low) / np.array(FORMULA.periods)),
    ]


def _powers(axis: Axis, unit: str) -> list[Profile]:
    def power(order: int) -> Profile:
        per = f"{unit}/({axis.unit})^{order}" if order > 1 else f"{unit}/({axis.unit})"
        mark = f"^{order}" if order > 1 else ""
        return Profile(
            ("linear", "quadratic", "cubic")[order - 1], np.zeros((1, 0)), lambda u, n: u[:, None] ** order,
            lambda n, a: {"slope": (float(a[0]), per)}, lambda u, p: p["slope"] * u**order,
            lambda name, p: f"{p['slope']:.4g} {name}{mark}",
        )  # fmt: skip

    return [power(order) for order in (1, 2, 3)]


def _local(axis: Axis, unit: str, low: float, high: float) -> list[Profile]:
    span = high - low
    places = np.linspace(low, high, FORMULA.middles + 2)[1:-1]
    widths = span * np.array(FORMULA.widths)
    decays = span * np.geomspace(*FORMULA.decays, FORMULA.decay_steps)
    decay = Profile(
        "decay", decays[:, None], lambda u, n: np.exp(-u / n[0])[:, None],
        lambda n, a: {"size": (float(a[0]), unit), "decay": (float(n[0]), axis.unit)},
        lambda u, p: p["size"] * np.exp(-u / p["decay"]),
        lambda name, p: f"{p['size']:.4g} exp(-{name} / {p['decay']:.4g} {axis.unit})",
    )  # fmt: skip
    bump = Profile(
        "bump", np.array(list(product(places, widths))),
        lambda u, n: np.exp(-0.5 * ((u - n[0]) / n[1]) ** 2)[:, None],
        lambda n, a: _placed(n, a, unit, axis.unit),
        lambda u, p: p["size"] * np.exp(-0.5 * ((u - p["middle"]) / p["width"]) ** 2),
        lambda name, p: f"{p['size']:.4g} exp(-({_less(name, p['middle'])} / {p['width']:.4g})^2 / 2)",
    )  # fmt: skip
    return [decay, bump, stripe(axis, unit, np.array(list(product(places, 2.0 * widths))))]


def stripe(axis: Axis, unit: str, grid: np.ndarray) -> Profile:
    """Return a size inside a stripe of the coordinate; `grid` (g, 2): its middles and widths."""
    return Profile(
        "stripe", grid, lambda u, n: _box(u, n[0], n[1])[:, None],
        lambda n, a: _placed(n, a, unit, axis.unit),
        lambda u, p: p["size"] * _box(u, p["middle"], p["width"]),
        lambda name, p: f"{p['size']:.4g} where |{_less(name, p['middle'])[1:-1]}| < {0.5 * p['width']:.4g}, else 0",
    )  # fmt: skip


def pulses(axis: Axis, unit: str, grid: np.ndarray) -> Profile:
    """Return a size inside stripes that come again and again; `grid` (g, 3): their middle, width and distance."""

    def folded(u: np.ndarray, middle: float, wave: float) -> np.ndarray:
        return (u - middle + 0.5 * wave) % wave - 0.5 * wave

    return Profile(
        "pulses", grid, lambda u, n: _box(folded(u, n[0], n[2]), 0.0, n[1])[:, None],
        lambda n, a: {**_placed(n, a, unit, axis.unit), "wave": (float(n[2]), axis.unit)},
        lambda u, p: p["size"] * _box(folded(u, p["middle"], p["wave"]), 0.0, p["width"]),
        lambda name, p: f"{p['size']:.4g} where |{_less(name, p['middle'])[1:-1]}| < {0.5 * p['width']:.4g}"
        f", every {p['wave']:.4g} {axis.unit}, else 0",
    )  # fmt: skip


def _less(name: str, value: float, unit: str = "") -> str:
    """Return a coordinate minus a number, in brackets."""
    return f"({name} {'-' if value >= 0.0 else '+'} {abs(value):.4g}{unit})"


def _placed(n: np.ndarray, a: np.ndarray, unit: str, of: str) -> Named:
    return {"size": (float(a[0]), unit), "middle": (float(n[0]), of), "width": (float(n[1]), of)}


def _box(u: np.ndarray, middle: float, width: float) -> np.ndarray:
    """Return 1 inside the stripe and 0 outside (n,), with smooth edges, so that their positions can be fitted."""
    edge = FORMULA.soft_edge * width + 1e-9
    return 0.5 * (np.tanh((u - middle + 0.5 * width) / edge) - np.tanh((u - middle - 0.5 * width) / edge))


def sine(axis: Axis, unit: str, lengths: np.ndarray) -> Profile:
    """Return a sine of the coordinate; `lengths` (g,): of its wave."""

    def named(n: np.ndarray, a: np.ndarray) -> Named:
        shift = float(np.arctan2(-a[1], a[0]) / (2 * np.pi) * n[0])
        return {"size": (float(np.hypot(*a)), unit), "wave": (float(n[0]), axis.unit), "shift": (shift, axis.unit)}

    return Profile(
        "sine", lengths[:, None],
        lambda u, n: np.stack([f(2 * np.pi * u / n[0]) for f in (np.sin, np.cos)], axis=1), named,
        lambda u, p: p["size"] * np.sin(2 * np.pi * (u - p["shift"]) / p["wave"]),
        lambda name, p: f"{p['size']:.4g} sin(2 pi {_less(name, p['shift'])} / {p['wave']:.4g} {axis.unit})",
    )  # fmt: skip


def harmonic(order: int, unit: str) -> Profile:
    """Return the cosine of a multiple, `order`, of an angle [°], with its phase and its size in `unit`."""

    def named(n: np.ndarray, a: np.ndarray) -> Named:
        return {
            "size": (float(np.hypot(*a)), unit),
            "toward": (float(np.degrees(np.arctan2(a[1], a[0])) / order), "deg"),
        }

    return Profile(
        f"harmonic {order}", np.zeros((1, 0)),
        lambda u, n: np.stack([f(order * np.radians(u)) for f in (np.cos, np.sin)], axis=1), named,
        lambda u, p: p["size"] * np.cos(order * np.radians(u - p["toward"])),
        lambda name, p: f"{p['size']:.4g} cos{_times(order, _less(name, p['toward'], ' deg'))}",
    )  # fmt: skip


def _times(order: int, bracket: str) -> str:
    return f"({order} {bracket})" if order > 1 else bracket


def form(profile: Profile, axis: Axis, directions: Sequence[Direction], unit: str) -> Form:
    """Return a profile of a coordinate as a law along directions, with sizes in `unit`.

    Each direction has its own amplitudes and, if the coordinate has one, an offset. The law is 0 where the coordinate
    is unknown.
    """
    known = np.isfinite(axis.values)
    u = np.where(known, axis.values, 0.0)

    def weights(nonlinear: np.ndarray) -> np.ndarray:
        columns = np.where(known[:, None], profile.columns(u, nonlinear), 0.0)
        return np.concatenate([columns, np.ones((len(u), 1))], axis=1) if axis.offset else columns

    def basis(nonlinear: np.ndarray) -> np.ndarray:
        w = weights(nonlinear)
        return np.concatenate([w[:, None, :] * one.vectors[:, :, None] for one in directions], axis=2)

    def named(nonlinear: np.ndarray, amplitude: np.ndarray) -> Named:
        found: Named = {}
        for one, own in zip(directions, np.split(amplitude, len(directions)), strict=True):
            some = profile.named(nonlinear, own[:-1] if axis.offset else own)
            some |= {"offset": (float(own[-1]), unit)} if axis.offset else {}
            found |= {_label(name, one, directions): value for name, value in some.items()}
        return found

    def of(values: Mapping[str, float], one: Direction) -> dict[str, float]:
        names = {name: _label(name, one, directions) for name in PARAMETERS}
        return {name: values[label] for name, label in names.items() if label in values}

    def law(values: Mapping[str, float]) -> np.ndarray:
        total = np.zeros_like(directions[0].vectors)
        for one in directions:
            own = of(values, one)
            size = np.where(known, profile.value(u, own), 0.0) + own.get("offset", 0.0)
            total = total + size[:, None] * one.vectors
        return total

    def words(values: Mapping[str, float]) -> str:
        several = len(directions) > 1
        return "; ".join(_sentence(profile, axis, one, of(values, one), unit, several) for one in directions)

    where = " and ".join(one.words for one in directions)
    return Form(f"{profile.name} of {axis.name} {where}", profile.grid, basis, named, law, words)


def _label(name: str, one: Direction, directions: Sequence[Direction]) -> str:
    return name if len(directions) == 1 or name in COMMON else f"{name}_{one.symbol}"


def _sentence(profile: Profile, axis: Axis, one: Direction, own: Mapping[str, float], unit: str, several: bool) -> str:
    symbol = f"{one.law}_{one.symbol}" if several else one.law
    law = profile.words(axis.name, own)
    signed = f"- {law[1:]}" if law.startswith("-") else f"+ {law}"
    right_side = f"({own['offset']:.4g} {signed})" if "offset" in own else law
    return " ".join(part for part in (symbol, "=", right_side, "" if unit == "1" else unit, one.words) if part)
