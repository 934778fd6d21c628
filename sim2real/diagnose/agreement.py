"""Whether recordings of one call are of one table: the law that each asks for by itself, tried on the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import permutations

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.explain import Explained, explain
from sim2real.diagnose.engine.fit import Fit, fit
from sim2real.diagnose.glide.data import GlideData
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.sanity import two_tables

LAUNCHES_ALONE, RESIDUALS_ALONE = 6, 24  # with fewer, a recording cannot ask for a law by itself
APART = 8.0  # standard deviations between two fits of one number
RELATIVE = 0.1  # of its size, which one table may change by from one day to the next
HARM = 30.0  # growth of a sum of squares that noise does not make
WORSE_SMALL = 2.0  # times what the noise leaves, under a law found elsewhere
WORSE = 1.1  # times the sum of squares without a law, with it
WORSE_SMOOTH = 1.5  # the same, softly, of a smooth law, which says little of places where its own recording has no puck


@dataclass(frozen=True)
class Part:
    """One recording of several: its `name` and the indices of its launches."""

    name: str
    clusters: np.ndarray


def parts_of(data: GlideData, names: Sequence[str]) -> list[Part]:
    """The launches of each recording, of these `names`."""
    return [Part(name, np.unique(data.cluster[data.recording == k])) for k, name in enumerate(names)]


def check_agreement(problem: Problem, shipped: Mapping[str, float], parts: Sequence[Part]) -> None:
    """Raise `UndeterminedError` if what recordings ask for, each by itself, cannot be one table.

    `shipped`: the simulator's own numbers, by name. A law that one recording asks for may not harm another, and its
    numbers may not be others there. A recording too small to ask for a law may not be worse than noise under that of
    another, or of all together where each is small.
    """
    live = np.flatnonzero(problem.freedom > 0)
    parts = [Part(part.name, np.intersect1d(part.clusters, live)) for part in parts]
    parts = [part for part in parts if len(part.clusters)]
    if len(parts) < 2:
        return
    small = [part for part in parts if not _enough(problem, part.clusters)]
    parts = [part for part in parts if _enough(problem, part.clusters)]
    alone = [explain(problem, shipped, part.clusters) for part in parts]
    _check_small(problem, small, alone, [part.name for part in parts], shipped)
    for one, other in permutations(range(len(parts)), 2):
        law, there = alone[one].law, parts[other].clusters
        whole = alone[one].unlisted is None  # numbers beside a smooth law stand for the places that it was fitted at
        told = _numbers_apart(law, fit(problem, law.values, law.free, there)) if whole else None
        if told:
            name, a, b = told
            why = f"{name} is {a:.3g} in the one and {b:.3g} in the other"
            raise two_tables(parts[one].name, parts[other].name, why)
        harm = _losses_under(problem, alone[one], alone[other], there)
        worse = WORSE if whole else WORSE_SMOOTH
        if harm[0] > worse * harm[1] and harm[0] - harm[1] > HARM * alone[other].dispersion:
            why = f"what the {problem.regime} of the one asks for makes the other's worse"
            raise two_tables(parts[one].name, parts[other].name, why)


def _enough(problem: Problem, clusters: np.ndarray) -> bool:
    return len(clusters) >= LAUNCHES_ALONE and problem.freedom[clusters].sum() >= RESIDUALS_ALONE


def _check_small(
    problem: Problem,
    small: Sequence[Part],
    alone: Sequence[Explained],
    names: Sequence[str],
    shipped: Mapping[str, float],
) -> None:
    """Raise `UndeterminedError` if one of the parts `small` fits none of the laws `alone`, of recordings `names`."""
    if not small:
        return
    if not alone:
        together = np.concatenate([part.clusters for part in small])
        if not _enough(problem, together):
            return
        alone, names = [explain(problem, shipped, together)], ["the others"]
    for part in small:
        freedom = float(problem.freedom[part.clusters].sum())
        excess = [
            _loss_as_foretold(problem, law, part.clusters) / law.dispersion - WORSE_SMALL * freedom for law in alone
        ]
        if min(excess) > HARM:
            name = names[int(np.argmin(excess))]
            raise two_tables(name, part.name, f"the {problem.regime} of the one foretells the other's badly")


def _loss_as_foretold(problem: Problem, found: Explained, clusters: np.ndarray) -> float:
    """Soft loss of `clusters` under a law found elsewhere, nothing refitted."""
    if found.unlisted is None:
        left = problem.residuals(found.law.values, (), clusters)
        loss = np.bincount(left.cluster, left.r**2, problem.clusters)
    else:
        grams, units = found.columns.grams, problem.units.of(clusters)
        columns = grams.columns((*found.law.free, *found.unlisted.columns))
        left = gram.losses(grams, columns, found.theta, units)
        loss = np.bincount(problem.units.cluster[units], left, problem.clusters)
    return float(gram.soft(loss[clusters], problem.freedom[clusters]).sum())


def _numbers_apart(one: Fit, other: Fit) -> tuple[str, float, float] | None:
    """The number that two fits disagree on most, and its values, if they surely do."""
    worst, told = APART, None
    for k, name in enumerate(one.free):
        a, b = float(one.values[name]), float(other.values[name])
        spread = float(np.sqrt(one.covariance[k, k] + other.covariance[k, k]))
        apart = abs(a - b) / max(spread, 1e-12)
        if apart > worst and abs(a - b) > RELATIVE * max(abs(a), abs(b)):
            worst, told = apart, (name, a, b)
    return told


def _losses_under(problem: Problem, found: Explained, own: Explained, clusters: np.ndarray) -> tuple[float, float]:
    """Losses of `clusters` under the effects found elsewhere and without them, with the baseline's numbers refitted.

    own: what was found in the clusters themselves.
    """
    if found.unlisted is None:
        return fit(problem, found.law.values, problem.base, clusters).loss, own.baseline.loss
    theta = found.theta[-len(found.unlisted.columns) :]
    columns = found.columns.grams.columns((*problem.base, *found.unlisted.columns))
    return _smooth_loss(problem, found, columns, theta, clusters), _smooth_loss(
        problem, found, columns, np.zeros_like(theta), clusters
    )


def _smooth_loss(problem: Problem, found: Explained, columns: np.ndarray, theta: np.ndarray, clusters) -> float:
    """Soft loss of `clusters` under the coefficients `theta` of a family, the last of `columns`; the rest refitted."""
    grams, units, base = found.columns.grams, problem.units.of(clusters), len(problem.base)
    g = grams.g[np.ix_(units, columns, columns)].sum(axis=0)
    b = grams.b[np.ix_(units, columns)].sum(axis=0)
    whole = np.concatenate([np.zeros(base), theta])
    whole[:base] = gram.solve_normal(g[:base, :base], -(b[:base] + g[:base, base:] @ theta))
    return float(gram.soft(gram.losses(grams, columns, whole, units), problem.units.freedom[units]).sum())
