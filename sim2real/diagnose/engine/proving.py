"""What untouched launches say of laws that were found without them. They choose nothing, but they may silence: what
foretells them no better than its absence is taken out, and what is left is fitted anew."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import MOST, Law
from sim2real.diagnose.engine.explain import Explained, bare, without
from sim2real.diagnose.finding import MUCH
from sim2real.diagnose.problem import Problem

BORNE = 0.1  # of what untouched launches have beyond noise, that a law must explain to be told
FELT = 16.0  # square of what a law foretells differently, below which it is chance that says whether it helps


@dataclass(frozen=True)
class Proved:
    """What stands: `found` without the laws that were `silenced`, and without `others`, which are not believed beside
    them; for each law of its model, by name, what is found `without` it."""

    found: Explained
    without: dict[str, Explained]
    silenced: tuple[Law, ...] = ()
    others: tuple[Law, ...] = ()


def prove(problem: Problem, found: Explained, proof: np.ndarray, clear: bool = True) -> Proved:
    """Hold what was found against the clusters `proof`, and take out, the most harmful first, what they speak against;
    where laws were taken out and most is left unexplained, the others stood in for something as well and go too.

    clear: whether what the regime rests on is known and proved; if not, what is not proved is not believed.
    """
    untouched, silenced = _Untouched(problem, proof, found.dispersion, clear), []
    while found.model.laws:
        others = {law.name: without(problem, found, law) for law in found.model.laws}
        against = [law for law in found.model.laws if not untouched.bear_out(found, others[law.name], (law,))]
        if not against:
            break
        worst = min(against, key=lambda law: untouched.gained(found, others[law.name]).sum())
        found, silenced = others[worst.name], [*silenced, worst]
    if not found.model.laws:
        return Proved(found, {}, tuple(silenced))
    if not untouched.bear_out(found, bare(found), found.model.laws):
        return Proved(bare(found), {}, (*silenced, *found.model.laws))
    if silenced and untouched.puzzled_by(found):
        return Proved(bare(found), {}, tuple(silenced), found.model.laws)
    return Proved(found, others, tuple(silenced))


class _Untouched:
    """Launches that no fit saw. Losses are soft (`gram.soft`): neither an odd launch nor an odd bounce decides."""

    def __init__(self, problem: Problem, proof: np.ndarray, dispersion: float, clear: bool) -> None:
        self._problem, self._proof, self._dispersion, self._clear = problem, proof, dispersion, clear
        rows = problem.residuals({}, (), proof)
        self._by_unit = rows.unit is not None
        self._part_of_row = rows.cluster if rows.unit is None else rows.unit
        cluster, freedom = np.arange(problem.clusters), problem.freedom
        if self._by_unit:
            cluster, freedom = problem.units.cluster, problem.units.freedom
        self._parts = np.flatnonzero(np.isin(cluster, proof) & (freedom > 0.0))
        self._freedom = freedom[self._parts] * dispersion
        self._launch = np.searchsorted(np.sort(proof), cluster[self._parts])

    def gained(self, found: Explained, other: Explained) -> np.ndarray:
        """By how much more (launches,) the `other` leaves of each."""
        return self._left(other) - self._left(found)

    def bear_out(self, found: Explained, other: Explained, laws: tuple[Law, ...]) -> bool:
        """Whether they speak for the `laws` that `found` has and the `other` has not, or at least not against them.

        Of numbers for each launch they say nothing, nor of listed laws that they hardly feel, if all else is clear. A
        family is a likeness of the truth and may fail where no launch that it was fitted to ever was: if those prove it
        to each other, untouched ones must be worse off together, by more than they scatter.
        """
        if any(law.each_launch for law in laws):
            return True
        gained = self.gained(found, other)
        if any(law.family for law in laws):
            if len(gained) > 1 and found.chooser.proved(found.model):
                return float(gained.sum()) >= -float(np.linalg.norm(gained))
        elif found.unlisted is None and self._felt(found, other) < FELT:
            return self._clear
        beyond = float(self._left(other).sum() - self._freedom.sum() / self._dispersion)
        return float(gained.sum()) > max(BORNE * beyond, 0.0)

    def puzzled_by(self, found: Explained) -> bool:
        """Whether much is left of them, and most of what there was."""
        much = float(self._soft(MUCH**2 * self._freedom).sum())
        plain, left = (float(self._left(one).sum()) for one in (bare(found), found))
        noise = float(self._freedom.sum()) / self._dispersion
        return left > much and plain - left < MOST * (plain - noise)

    def _left(self, found: Explained) -> np.ndarray:
        """Soft loss (launches,) of each."""
        return np.bincount(self._launch, self._soft(self._squares(found)), len(self._proof))

    def _soft(self, squares: np.ndarray) -> np.ndarray:
        return gram.soft(squares, self._freedom) / self._dispersion

    def _squares(self, found: Explained) -> np.ndarray:
        if found.unlisted is None:
            return self._summed(self._rows(found) ** 2)
        units = self._problem.units.of(self._proof)
        left = np.bincount(units, found.left(units), len(self._problem.units.cluster))
        if not self._by_unit:
            left = np.bincount(self._problem.units.cluster, left, self._problem.clusters)
        return left[self._parts]

    def _felt(self, one: Explained, other: Explained) -> float:
        """Squares, as soft as losses, of what two fits foretell differently."""
        return float(self._soft(self._summed((self._rows(one) - self._rows(other)) ** 2)).sum())

    def _rows(self, found: Explained) -> np.ndarray:
        return self._problem.residuals(found.law.values, (), self._proof).r

    def _summed(self, rows: np.ndarray) -> np.ndarray:
        """Rows of residuals, summed up by part."""
        return np.bincount(self._part_of_row, rows)[self._parts]
