"""Central forces as candidate formulas: vortices, sources, and a patch of friction about a point of the table."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import product

import numpy as np

from sim2real.diagnose.formula.shapes import Form, Named
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.tuned import SLIDING

ROUND, OUTWARD = "round", "away from"


def pushes(motion: Motion) -> list[Form]:
    """Forces around a point or away from it, either proportional to the distance or local to the point."""
    return [make(motion, direction) for make in (_rigid, _local) for direction in (ROUND, OUTWARD)]


def brake(motion: Motion) -> Form:
    """A friction force that is largest at a point."""

    def at(x: float, y: float, width: float) -> np.ndarray:
        offset = motion.place - (x, y)
        return np.exp(-0.5 * (offset**2).sum(axis=1) / width**2)[:, None] * motion.along

    return Form(
        "patch", _points(motion), lambda n: at(*n)[:, :, None],
        lambda n, a: _spot(n, float(a[0])), lambda p: p["size"] * at(p["x"], p["y"], p["radius"]),
        lambda p: f"a = {p['size']:.4g} exp(-(r / {p['radius']:.4g} m)^2 / 2) m/s^2 along the motion, {_about(p)}",
    )  # fmt: skip


def _offsets(motion: Motion, x: float, y: float, direction: str) -> np.ndarray:
    """Vectors (n, 2) [m] from a point to each place, rotated by 90 degrees to the left for ROUND."""
    offset = motion.place - (x, y)
    return np.stack([-offset[:, 1], offset[:, 0]], axis=1) if direction == ROUND else offset


def _rigid(motion: Motion, direction: str) -> Form:
    axes = np.tile(np.eye(2), (len(motion.t), 1, 1))

    def named(n: np.ndarray, a: np.ndarray) -> Named:
        rate = float(a[0]) or 1e-12
        x, y = (-a[2] / rate, a[1] / rate) if direction == ROUND else (-a[1] / rate, -a[2] / rate)
        return {"rate": (rate, "1/s^2"), "x": (float(x), "m"), "y": (float(y), "m")}

    return Form(
        f"rigid {direction}", np.zeros((1, 0)),
        lambda n: np.concatenate([_offsets(motion, 0.0, 0.0, direction)[:, :, None], axes], axis=2), named,
        lambda p: p["rate"] * _offsets(motion, p["x"], p["y"], direction),
        lambda p: f"a = {p['rate']:.4g} r 1/s^2 {_words(direction)}, {_about(p)}",
    )  # fmt: skip


def _local(motion: Motion, direction: str) -> Form:
    def at(x: float, y: float, radius: float) -> np.ndarray:
        offset = _offsets(motion, x, y, direction) / radius
        return np.exp(0.5 - 0.5 * (offset**2).sum(axis=1))[:, None] * offset

    return Form(
        f"local {direction}", _points(motion), lambda n: at(*n)[:, :, None], lambda n, a: _spot(n, float(a[0])),
        lambda p: p["size"] * at(p["x"], p["y"], p["radius"]),
        lambda p: f"a = {p['size']:.4g} (r / {p['radius']:.4g} m) exp((1 - (r / {p['radius']:.4g} m)^2) / 2) m/s^2 "
        f"{_words(direction)}, {_about(p)}",
    )  # fmt: skip


def _spot(n: np.ndarray, size: float) -> Named:
    return {"size": (size, "m/s^2"), "x": (float(n[0]), "m"), "y": (float(n[1]), "m"), "radius": (float(n[2]), "m")}


def _points(motion: Motion) -> np.ndarray:
    x, y = (np.linspace(0.1, 0.9, count) * size for count, size in zip((6, 4), motion.size, strict=True))
    return np.array(list(product(x, y, np.array(SLIDING.central_sizes) * motion.size[1])))


def _about(p: Mapping[str, float]) -> str:
    return f"r from ({p['x']:.4g}, {p['y']:.4g}) m"


def _words(direction: str) -> str:
    return "turning left round it" if direction == ROUND else "away from it"
