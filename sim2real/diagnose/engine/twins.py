"""Controls of a proof: the same laws, fitted and tried likewise, where by construction nothing is to be found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Model
from sim2real.diagnose.engine.gram import Grams
from sim2real.diagnose.problem import Units

DRAWS = 20
NULL, PERMUTED = "null", "permutation"

Twins = Mapping[str, tuple[float, float]]


def twins(grams: Grams, units: Units, model: Model, use: np.ndarray, proof: np.ndarray) -> Twins:
    """The rms residuals (before, after), in units of the noise, that twins of the clusters `proof` have without and
    with the laws of `model`, fitted to the same twins of the clusters `use`; means of DRAWS twins.

    A null twin is the sensor's noise about the baseline; in a permutation twin the residuals of every launch keep their
    size, but their signs are drawn, launch by launch.
    """
    drawn: Mapping[str, Callable[[np.random.Generator], Grams]] = {
        NULL: lambda rng: _noise(inner, units, rng),
        PERMUTED: lambda rng: _flipped(rest, units, rng),
    }
    columns, ridge = model.columns(grams)
    inner = _only(grams, columns)
    base = np.arange(len(model.base))
    rest = _without(inner, base, units, np.union1d(use, proof))
    rng = np.random.default_rng(0)
    found = {}
    for name, draw in drawn.items():
        tried = np.array([list(_tried(draw(rng), units, base, ridge, use, proof)) for _ in range(DRAWS)])
        found[name] = float(tried[:, 0].mean()), float(tried[:, 1].mean())
    return found


def _tried(grams: Grams, units: Units, base: np.ndarray, ridge: np.ndarray, use, proof) -> Iterator[float]:
    """Rms of the residuals of `proof` under the baseline, and under all columns, fitted to `use`."""
    fitted, tried = units.of(use), units.of(proof)
    for columns in (base, np.arange(len(ridge))):
        theta = gram.solve_softly(grams, columns, fitted, units.freedom[fitted], ridge[: len(columns)])
        left = gram.losses(grams, columns, theta, tried).sum()
        yield float(np.sqrt(max(left, 0.0) / max(units.freedom[tried].sum(), 1.0)))


def _only(grams: Grams, columns: np.ndarray) -> Grams:
    names = tuple(grams.names[k] for k in columns)
    return replace(grams, names=names, g=grams.g[:, columns][:, :, columns], b=grams.b[:, columns])


def _without(grams: Grams, base: np.ndarray, units: Units, clusters: np.ndarray) -> Grams:
    """What the baseline, fitted to `clusters`, leaves."""
    some = units.of(clusters)
    theta = np.zeros(len(grams.names))
    theta[base] = gram.solve_softly(grams, base, some, units.freedom[some])
    left = gram.losses(grams, np.arange(len(theta)), theta, np.arange(grams.clusters))
    return replace(grams, b=grams.b + grams.g @ theta, s=left)


def _flipped(grams: Grams, units: Units, rng: np.random.Generator) -> Grams:
    sign = rng.choice((-1.0, 1.0), units.cluster.max(initial=0) + 1)[units.cluster]
    return replace(grams, b=sign[:, None] * grams.b)


def _noise(grams: Grams, units: Units, rng: np.random.Generator) -> Grams:
    """Sums of residuals that are white noise: b = J'e has the covariance J'J, and s = e'e holds what J does not see."""
    value, vector = np.linalg.eigh(grams.g)
    seen = value > gram.TINY * np.maximum(value[:, -1:], 1e-300)
    e = np.where(seen, rng.normal(size=value.shape), 0.0)
    b = np.einsum("cij,cj->ci", vector, np.sqrt(np.maximum(value, 0.0)) * e)
    unseen = np.maximum(units.freedom - seen.sum(axis=1), 0.0)
    s = (e**2).sum(axis=1) + np.where(unseen > 0.0, rng.chisquare(np.maximum(unseen, 1e-9)), 0.0)
    return replace(grams, b=b, s=s)
