"""Forces about a point of the table as readable laws: whirls, sources, and a patch that brakes."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import numpy as np

from sim2real.diagnose.forms import Form, Named
from sim2real.diagnose.glide.families import Motion

SIZES = (0.1, 0.2, 0.35)  # of the table's width
ROUND, OUTWARD = "round", "away from"


def pushes(motion: Motion) -> list[Form]:
    """Forces that turn round a point or point away from it: as far as the table, or around the point alone."""
    return [make(motion, way) for make in (_rigid, _local) for way in (ROUND, OUTWARD)]


def brake(motion: Motion) -> Form:
    """A brake that is strongest at a point."""

    def at(x: float, y: float, width: float) -> np.ndarray:
        away = motion.place - (x, y)
        return np.exp(-0.5 * (away**2).sum(axis=1) / width**2)[:, None] * motion.along

    return Form(
        "patch", _points(motion), lambda n: at(*n)[:, :, None],
        lambda n, a: _spot(n, float(a[0])), lambda p: p["size"] * at(p["x"], p["y"], p["radius"]),
        lambda p: f"a = {p['size']:.4g} exp(-(r / {p['radius']:.4g} m)^2 / 2) m/s^2 along the motion, {_about(p)}",
    )  # fmt: skip


def turned(motion: Motion, x: float, y: float, way: str) -> np.ndarray:
    """Vectors (n, 2) from a point to each place, turned a quarter to the left for ROUND."""
    away = motion.place - (x, y)
    return np.stack([-away[:, 1], away[:, 0]], axis=1) if way == ROUND else away


def _rigid(motion: Motion, way: str) -> Form:
    axes = np.tile(np.eye(2), (len(motion.t), 1, 1))

    def named(n: np.ndarray, a: np.ndarray) -> Named:
        rate = float(a[0]) or 1e-12
        x, y = (-a[2] / rate, a[1] / rate) if way == ROUND else (-a[1] / rate, -a[2] / rate)
        return {"rate": (rate, "1/s^2"), "x": (float(x), "m"), "y": (float(y), "m")}

    return Form(
        f"rigid {way}", np.zeros((1, 0)),
        lambda n: np.concatenate([turned(motion, 0.0, 0.0, way)[:, :, None], axes], axis=2), named,
        lambda p: p["rate"] * turned(motion, p["x"], p["y"], way),
        lambda p: f"a = {p['rate']:.4g} r 1/s^2 {_way(way)}, {_about(p)}",
    )  # fmt: skip


def _local(motion: Motion, way: str) -> Form:
    def at(x: float, y: float, radius: float) -> np.ndarray:
        away = turned(motion, x, y, way) / radius
        return np.exp(0.5 - 0.5 * (away**2).sum(axis=1))[:, None] * away

    return Form(
        f"local {way}", _points(motion), lambda n: at(*n)[:, :, None], lambda n, a: _spot(n, float(a[0])),
        lambda p: p["size"] * at(p["x"], p["y"], p["radius"]),
        lambda p: f"a = {p['size']:.4g} (r / {p['radius']:.4g} m) exp((1 - (r / {p['radius']:.4g} m)^2) / 2) m/s^2 "
        f"{_way(way)}, {_about(p)}",
    )  # fmt: skip


def _spot(n: np.ndarray, size: float) -> Named:
    return {"size": (size, "m/s^2"), "x": (float(n[0]), "m"), "y": (float(n[1]), "m"), "radius": (float(n[2]), "m")}


def _points(motion: Motion) -> np.ndarray:
    x, y = (np.linspace(0.1, 0.9, count) * size for count, size in zip((6, 4), motion.size, strict=True))
    return np.array(list(product(x, y, np.array(SIZES) * motion.size[1])))


def _about(p: Mapping[str, float]) -> str:
    return f"r from ({p['x']:.4g}, {p['y']:.4g}) m"


def _way(way: str) -> str:
    return "turning left round it" if way == ROUND else "away from it"
