"""Controls of a proof: the same laws, and a search among them and all that have a name, where by construction nothing
is to be found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Chooser, Model
from sim2real.diagnose.engine.gram import Grams
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.noise import dispersion
from sim2real.diagnose.finding import Twin
from sim2real.diagnose.problem import Units

DRAWS = 6  # of each kind of twin; each costs a search
NULL, PERMUTED = "null", "permutation"


def twins(
    grams: Grams, units: Units, model: Model, listed: Sequence[Law], use: np.ndarray, proof: np.ndarray
) -> dict[str, Twin]:
    """What twins of a recording say, by name, of the laws of `model`, fitted to the twins of the clusters `use` and
    tried on those of `proof`.

    A null twin is the sensor's noise about the baseline; a search among the `listed` laws, and those of the model (a
    wave at the length that was found), should find nothing in it. In a permutation twin the residuals of every launch
    keep their size, but their signs are drawn, launch by launch: they are as smooth as what is missing, so that a
    search would take some of them for other laws, and is not asked.
    """
    laws = list({law.columns: law for law in (*model.laws, *listed)}.values())
    every = Model(model.base, tuple(laws), (1.0,) * len(laws))
    inner = _only(grams, every.columns(grams)[0])
    rest = _without(inner, inner.columns(model.base), units, use)
    drawn: Mapping[str, Callable[[np.random.Generator], Grams]] = {
        NULL: lambda rng: _noise(inner, units, rng),
        PERMUTED: lambda rng: _flipped(rest, rng),
    }
    rng, found = np.random.default_rng(0), {}
    for name, draw in drawn.items():
        some = [draw(rng) for _ in range(DRAWS)]
        before, after = np.mean([list(_tried(one, units, model, use, proof)) for one in some], axis=0)
        found[name] = Twin(float(before), float(after))
        if name == NULL:
            found[name] = replace(
                found[name], named=sum(_names(one, units, model, laws, use) for one in some), of=DRAWS
            )
    return found


def _names(grams: Grams, units: Units, model: Model, laws: Sequence[Law], use: np.ndarray) -> bool:
    """Whether a search finds that something is missing."""
    chooser = Chooser(grams, units, use, dispersion(grams, units, model.base, laws, use))
    return bool(chooser.prune(chooser.add(Model(model.base), laws, len(model.laws))).laws)


def _tried(grams: Grams, units: Units, model: Model, use: np.ndarray, proof: np.ndarray) -> Iterator[float]:
    """Rms of the residuals of `proof` under the baseline, and under the model, fitted to `use`."""
    fitted, tried = units.of(use), units.of(proof)
    for one in (Model(model.base), model):
        columns, ridge = one.columns(grams)
        theta = gram.solve_softly(grams, columns, fitted, units.freedom[fitted], ridge)
        left = gram.losses(grams, columns, theta, tried).sum()
        yield float(np.sqrt(max(left, 0.0) / max(units.freedom[tried].sum(), 1.0)))


def _only(grams: Grams, columns: np.ndarray) -> Grams:
    names = tuple(grams.names[k] for k in columns)
    return replace(grams, names=names, g=grams.g[:, columns][:, :, columns], b=grams.b[:, columns])


def _without(grams: Grams, base: np.ndarray, units: Units, use: np.ndarray) -> Grams:
    """What the baseline, fitted to the clusters `use`, leaves of all."""
    some = units.of(use)
    theta = np.zeros(len(grams.names))
    theta[base] = gram.solve_softly(grams, base, some, units.freedom[some])
    left = gram.losses(grams, np.arange(len(theta)), theta, np.arange(grams.clusters))
    return replace(grams, b=grams.b + grams.g @ theta, s=left)


def _flipped(grams: Grams, rng: np.random.Generator) -> Grams:
    return replace(grams, b=rng.choice((-1.0, 1.0), (grams.clusters, 1)) * grams.b)


def _noise(grams: Grams, units: Units, rng: np.random.Generator) -> Grams:
    """Sums of residuals that are white noise: b = J'e has the covariance J'J, and s = e'e holds what J does not see."""
    value, vector = np.linalg.eigh(grams.g)
    seen = value > gram.TINY * np.maximum(value[:, -1:], 1e-300)
    e = np.where(seen, rng.normal(size=value.shape), 0.0)
    b = np.einsum("cij,cj->ci", vector, np.sqrt(np.maximum(value, 0.0)) * e)
    unseen = np.maximum(units.freedom - seen.sum(axis=1), 0.0)
    s = (e**2).sum(axis=1) + np.where(unseen > 0.0, rng.chisquare(np.maximum(unseen, 1e-9)), 0.0)
    return replace(grams, b=b, s=s)
