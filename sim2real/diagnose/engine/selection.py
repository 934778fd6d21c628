"""Which of the laws that were found stand: each launch is predicted by numbers fitted to the launches of other folds,
and a law that predicts them no better than its absence does is rejected. What is left is fitted anew.

The data that prove are none of these launches: they are not at hand here (`split`, `prove`).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import MOST
from sim2real.diagnose.engine.explain import Explained, bare, without
from sim2real.diagnose.engine.fit import Fit, soft_loss
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import MUCH
from sim2real.diagnose.problem import Problem, Residuals

FOLDS = 5  # of the launches
BORNE = 0.1  # of what launches have beyond noise, that a law must explain to be kept
FELT = 16.0  # square of what a law predicts differently, below which it is chance that says whether it helps


@dataclass(frozen=True)
class Selected:
    """What stands: `found` without the laws that were `rejected`, and without `others`, which are not believed beside
    them; for each law of its model, by name, what is found `without` it. `small`: by name, the size [m] of laws that
    are sure, but too small to matter."""

    found: Explained
    without: dict[str, Explained]
    rejected: tuple[Law, ...] = ()
    others: tuple[Law, ...] = ()
    small: Mapping[str, float] = field(default_factory=dict)


def select(problem: Problem, found: Explained, clear: bool = True) -> Selected:
    """Hold what was found against launches that its numbers were not fitted to, and reject, the most harmful first, the
    laws that they speak against; where laws were rejected and most is left unexplained, the others stood in for
    something as well and go too.

    clear: whether what the regime rests on is known and stood this test; if not, a law that is not felt goes.
    """
    crossed, rejected = CrossValidated(problem, found.dispersion), []
    while found.model.laws:
        others = {law.name: without(problem, found, law) for law in found.model.laws}
        against = [law for law in found.model.laws if not crossed.bear_out(found, others[law.name], (law,), clear)]
        if not against:
            break
        worst = min(against, key=lambda law: crossed.gained(found, others[law.name]).sum())
        found, rejected = others[worst.name], [*rejected, worst]
    if not found.model.laws:
        return Selected(found, {}, tuple(rejected))
    if not crossed.bear_out(found, bare(found), found.model.laws, clear):
        return Selected(bare(found), {}, (*rejected, *found.model.laws))
    if rejected and crossed.puzzled_by(found):
        return Selected(bare(found), {}, tuple(rejected), found.model.laws)
    return Selected(found, others, tuple(rejected))


class CrossValidated:
    """What laws leave of each launch when their numbers are fitted to the launches of the other folds: one step of
    Gauss-Newton from the fit to all. Losses are soft (`gram.soft`): neither an odd launch nor an odd contact decides;
    `dispersion`: noise beyond the problem's, in variance."""

    def __init__(self, problem: Problem, dispersion: float) -> None:
        self._problem, self._dispersion = problem, dispersion
        self.launches = np.flatnonzero(problem.freedom > 0)
        self._fold = np.zeros(problem.clusters, int)
        self._fold[self.launches] = np.arange(len(self.launches)) % FOLDS
        rows = problem.residuals({}, (), self.launches)
        self._by_unit = rows.unit is not None
        cluster, freedom = np.arange(problem.clusters), problem.freedom
        if self._by_unit:
            cluster, freedom = problem.units.cluster, problem.units.freedom
        self._parts = np.flatnonzero(np.isin(cluster, self.launches) & (freedom > 0.0))
        self._freedom = freedom[self._parts] * dispersion
        self._launch = np.searchsorted(self.launches, cluster[self._parts])

    def rms(self, found: Explained) -> float:
        """Rms residual that laws leave, in units of the noise."""
        return float(np.sqrt(self._squares(found).sum() / max(self._freedom.sum() / self._dispersion, 1.0)))

    def left(self, found: Explained) -> np.ndarray:
        """Soft loss (launches,) of each."""
        return np.bincount(self._launch, self._soft(self._squares(found)), len(self.launches))

    def gained(self, found: Explained, other: Explained) -> np.ndarray:
        """By how much more (launches,) the `other` leaves of each."""
        return self.left(other) - self.left(found)

    def bear_out(self, found: Explained, other: Explained, laws: tuple[Law, ...], clear: bool) -> bool:
        """Whether launches speak for the `laws` that `found` has and the `other` has not, or at least not against them.

        Of numbers for each launch they say nothing, nor of listed laws that they hardly feel, if all else is clear. A
        family is a likeness of the truth and may fail where hardly any launch ever was: if launches predict each other
        with it, they must be worse off together, by more than they scatter.
        """
        if any(law.each_launch for law in laws):
            return True
        gained = self.gained(found, other)
        if any(law.family for law in laws):
            if len(gained) > 1 and found.chooser.proved(found.model):
                return float(gained.sum()) >= -float(np.linalg.norm(gained))
        elif found.unlisted is None and self._felt(found, other) < FELT:
            return clear
        beyond = float(self.left(other).sum() - self._freedom.sum() / self._dispersion)
        return float(gained.sum()) > max(BORNE * beyond, 0.0)

    def puzzled_by(self, found: Explained) -> bool:
        """Whether much is left, and most of what there was."""
        much = float(self._soft(MUCH**2 * self._freedom).sum())
        plain, left = (float(self.left(one).sum()) for one in (bare(found), found))
        noise = float(self._freedom.sum()) / self._dispersion
        return left > much and plain - left < MOST * (plain - noise)

    def _soft(self, squares: np.ndarray) -> np.ndarray:
        return gram.soft(squares, self._freedom) / self._dispersion

    def _squares(self, found: Explained) -> np.ndarray:
        """Sums of squares (parts,) that laws leave, each part predicted by the other folds."""
        if found.unlisted is None:
            rows = self._problem.residuals(found.law.values, found.law.free, self.launches)
            return self._summed(self._predicted(found.law, rows), rows)
        units = self._problem.units.of(self.launches)
        left = np.bincount(units, self._by_family(found, units), len(self._problem.units.cluster))
        if not self._by_unit:
            left = np.bincount(self._problem.units.cluster, left, self._problem.clusters)
        return left[self._parts]

    def _predicted(self, law: Fit, rows: Residuals) -> np.ndarray:
        """Residuals (n,), each after the step of the law's numbers, those at a bound aside, that the other folds take;
        a step that leads uphill there, as over the edge of a patch, is none."""
        moving = [name for name in law.free if name not in law.bound]
        jacobian, left = rows.jacobian[:, [law.free.index(name) for name in moving]], rows.r.copy()
        weight, fold = soft_loss(self._problem, rows)[1], self._fold[rows.cluster]
        for out in range(FOLDS) if moving else ():
            seen = fold != out
            inner, rest = weight[seen, None] * jacobian[seen], weight[seen] * rows.r[seen]
            step = -gram.solve_normal(inner.T @ inner, inner.T @ rest)
            values = {name: BY_NAME[name].within(law.values[name] + by) for name, by in zip(moving, step, strict=True)}
            stepped = self._problem.residuals({**law.values, **values}, (), self.launches).r
            if np.sum((weight[seen] * stepped[seen]) ** 2) < np.sum(rest**2):
                left[~seen] = stepped[~seen]
        return left

    def _by_family(self, found: Explained, units: np.ndarray) -> np.ndarray:
        """Sums of squares (units,) that laws with a family on top leave, each unit predicted by the other folds."""
        assert found.smooth is not None
        if found.smooth.family.each_launch:
            return found.left(units)
        grams, freedom = found.smooth.columns.grams, self._problem.units.freedom
        columns, ridge = found.smooth.model.columns(grams)
        fold, left = self._fold[self._problem.units.cluster[units]], np.zeros(len(units))
        for out in range(FOLDS):
            seen, tried = units[fold != out], units[fold == out]
            theta = gram.solve_softly(grams, columns, seen, freedom[seen] * self._dispersion, ridge)
            left[fold == out] = gram.losses(grams, columns, theta, tried)
        return left

    def _felt(self, one: Explained, other: Explained) -> float:
        """Squares, as soft as losses, of what two fits predict differently."""
        rows = [self._problem.residuals(each.law.values, (), self.launches) for each in (one, other)]
        return float(self._soft(self._summed(rows[0].r - rows[1].r, rows[0])).sum())

    def _summed(self, left: np.ndarray, rows: Residuals) -> np.ndarray:
        """Squares of residuals, summed up by part."""
        part = rows.cluster if rows.unit is None else rows.unit
        return np.bincount(part, left**2, self._parts.max(initial=-1) + 1)[self._parts]
