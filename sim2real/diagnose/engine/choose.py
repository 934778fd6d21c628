"""Which laws a recording asks for: candidates compared by how well they foretell pieces that their fit did not see."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.gram import Grams
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Units

FOLDS = 10  # parts of the launches, each foretold by what the others say
LEAST_FIT = 30.0  # drop of the loss (and 2 more a parameter, and for each e-fold of places) that is no chance
LEAST_FORETOLD = 12.0  # drop of the held-out loss
LEAST_ELSEWHERE = 2.0  # the same in all launches but the one that gains most
RESAMPLED, UNSURE = 400, 0.02  # draws of launches, and the share of them in which a law may be of no use
UNKNOWN = 4.0  # sum of squares a column, below which half of the launches does not tell a sign
LEAST_SHARE = 0.05  # of what all laws together explain, or, where they explain far more than the noise,
NOTICEABLE = 0.05  # of the noise's own sum of squares, that a law must explain to be needed
MOST = 0.5  # of what is beyond noise, that laws which other launches prove explain
AMBIGUOUS = 9.0  # held-out losses nearer than this do not tell two laws apart
LOOSE = 0.1  # ridge of a nonlinear law's coefficients, of which 1 is the law as it is looked for
SPREADS = (0.03, 0.3, 3.0)  # tried for the coefficients of a family


@dataclass(frozen=True)
class Gain:
    """What a law adds to those of `beside`: drop of the soft loss when fitted, and of each launch's when foretold."""

    beside: Model
    law: Law
    fitted: float
    foretold: np.ndarray
    spread: float

    @property
    def total(self) -> float:
        return float(self.foretold.sum())

    @property
    def without_best(self) -> float:
        """The total without the launch that gains most: no single one may carry a discovery."""
        return self.total - float(self.foretold.max())


@dataclass(frozen=True)
class Model:
    """The baseline's columns and those of laws added to it, each family with the spread of its coefficients."""

    base: tuple[str, ...]
    laws: tuple[Law, ...] = ()
    spreads: tuple[float, ...] = ()

    def plus(self, law: Law, spread: float) -> Model:
        return Model(self.base, (*self.laws, law), (*self.spreads, spread))

    def minus(self, law: Law) -> Model:
        kept = [(one, spread) for one, spread in zip(self.laws, self.spreads, strict=True) if one is not law]
        return Model(self.base, tuple(one for one, _ in kept), tuple(spread for _, spread in kept))

    @property
    def names(self) -> tuple[str, ...]:
        """The names of all columns, each once."""
        return tuple(dict.fromkeys((*self.base, *(name for law in self.laws for name in law.columns))))

    @property
    def key(self) -> tuple[Any, ...]:
        """What tells it from others."""
        return (self.base, tuple(law.columns for law in self.laws), self.spreads)

    def columns(self, grams: Grams) -> tuple[np.ndarray, np.ndarray]:
        """Indices of all columns, and the ridge of each (0 for parameters that have no prior)."""
        names, ridge = list(self.base), [0.0] * len(self.base)
        for law, spread in zip(self.laws, self.spreads, strict=True):
            fresh = [name for name in law.columns if name not in names]
            names += fresh
            ridge += [1.0 / spread**2 if law.family else LOOSE if law.start else 0.0] * len(fresh)
        return grams.columns(names), np.array(ridge)


class Chooser:
    """Compares models on the units of the clusters `use`; `dispersion` >= 1 is noise beyond the sensor's, in variance;
    `least`: what a law must explain to be told, in units of the noise, as where the sensor has errors of other kinds.

    Losses are soft (`gram.soft`): a few parts of the data that no law explains outweigh the rest in no comparison.
    """

    def __init__(
        self, grams: Grams, units: Units, use: np.ndarray, dispersion: float = 1.0, least: float = 0.0
    ) -> None:
        self.grams, self.use, self.dispersion, self.least = grams, units.of(use), dispersion, least
        self._freedom = units.freedom[self.use] * dispersion
        self._launch = np.unique(units.cluster[self.use], return_inverse=True)[1]
        draws = np.random.default_rng(0).integers(self._launches, size=(RESAMPLED, self._launches))
        self._known: dict[tuple[Any, ...], Any] = {}
        self._resampled = np.stack([np.bincount(row, minlength=self._launches) for row in draws])

    @property
    def _launches(self) -> int:
        return int(self._launch.max()) + 1

    @property
    def noise(self) -> float:
        """Loss that noise alone leaves."""
        return float(self._freedom.sum()) / self.dispersion

    def fitted(self, model: Model) -> float:
        """Loss that a model leaves when fitted to all units."""
        return self._once("fitted", model, self._fitted)

    def foretold(self, model: Model) -> np.ndarray:
        """Loss of each launch, its units foretold by the model fitted to those of the other folds: other units, of this
        launch or another, since what a single launch met, such as a patch, no other launch may know."""
        return self._once("foretold", model, self._foretold)

    def _once(self, what: str, model: Model, work: Callable[[Model], Any]) -> Any:
        key = (what, *model.key)
        if key not in self._known:
            self._known[key] = work(model)
        return self._known[key]

    def _fitted(self, model: Model) -> float:
        columns, ridge = model.columns(self.grams)
        theta = gram.solve_softly(self.grams, columns, self.use, self._freedom, ridge)
        left = gram.losses(self.grams, columns, theta, self.use)
        return float(gram.soft(left, self._freedom).sum()) / self.dispersion

    def _foretold(self, model: Model) -> np.ndarray:
        columns, ridge = model.columns(self.grams)
        left, folds = np.zeros(len(self.use)), np.arange(len(self.use)) % FOLDS
        for out in (folds == fold for fold in np.unique(folds)):
            theta = gram.solve_softly(self.grams, columns, self.use[~out], self._freedom[~out], ridge)
            left[out] = gram.losses(self.grams, columns, theta, self.use[out])
        return np.bincount(self._launch, gram.soft(left, self._freedom)) / self.dispersion

    def gain(self, model: Model, law: Law) -> Gain:
        """What `law` adds to `model`; a family with the best of SPREADS."""
        before, fitted = self.foretold(model), self.fitted(model)
        best: Gain | None = None
        for spread in SPREADS if law.family else (np.inf,):
            more = model.plus(law, spread)
            gain = Gain(model, law, fitted - self.fitted(more), before - self.foretold(more), spread)
            if best is None or gain.total > best.total:
                best = gain
        assert best is not None
        return best

    def fits(self, gain: Gain) -> bool:
        """Whether a law fits better than chance lets it, and explains enough."""
        chance = LEAST_FIT + 2.0 * len(gain.law.columns) + 2.0 * float(np.log(gain.law.searched))
        return gain.fitted > max(chance, self.least)

    def passes(self, gain: Gain) -> bool:
        """Whether a gain is more than chance, in the fit and on held-out units, and not the doing of few launches: any
        of them may be missed, or two far beyond chance say the same, each as the others foretell it."""
        if not self.fits(gain) or gain.total <= LEAST_FORETOLD or gain.without_best <= LEAST_ELSEWHERE:
            return False
        if float(np.quantile(self._resampled @ gain.foretold, UNSURE)) > 0.0:
            return True
        two = np.argsort(gain.foretold)[-2:]
        if float(gain.foretold[two].min()) <= LEAST_FIT:
            return False
        more = gain.beside.plus(gain.law, gain.spread)
        return bool((self.left_out(gain.beside)[two] - self.left_out(more)[two]).min() > LEAST_FIT)

    def left_out(self, model: Model) -> np.ndarray:
        """Loss of each launch, foretold by the model fitted to all other launches."""
        return self._once("left out", model, self._left_out)

    def _left_out(self, model: Model) -> np.ndarray:
        columns, ridge = model.columns(self.grams)
        left = np.zeros(len(self.use))
        for out in (self._launch == launch for launch in range(self._launches)):
            theta = gram.solve_softly(self.grams, columns, self.use[~out], self._freedom[~out], ridge)
            left[out] = gram.losses(self.grams, columns, theta, self.use[out])
        return np.bincount(self._launch, gram.soft(left, self._freedom)) / self.dispersion

    def proved(self, model: Model) -> bool:
        """Whether launches prove laws to each other, each foretold by the others: what they gain is most of what the
        baseline leaves beyond noise, no small thing, and not the doing of few."""
        plain = self.left_out(Model(model.base))
        gained = plain - self.left_out(model)
        enough = max(MOST * (float(plain.sum()) - self.noise), NOTICEABLE * self.noise)
        steady = float(np.quantile(self._resampled @ gained, UNSURE)) > 0.0
        return steady and float(gained.sum()) > enough

    def doubtful(self, gain: Gain) -> bool:
        """Whether a law fits far better than chance lets it, and yet does not pass: few launches ask for it."""
        return self.fits(gain) and not self.passes(gain)

    def same_in_both_halves(self, model: Model, law: Law) -> bool:
        """Whether the odd and the even launches ask for the law with the same sign, as far as either knows."""
        columns, ridge = model.plus(law, 1.0).columns(self.grams)
        at = np.isin(columns, self.grams.columns(law.columns))
        halves, known = [], []
        for k in (0, 1):
            some = self._launch % 2 == k
            halves.append(gram.solve_softly(self.grams, columns, self.use[some], self._freedom[some], ridge)[at])
            seen = self.grams.g[np.ix_(self.use[some], columns[at], columns[at])].sum(axis=0)
            known.append(float(halves[k] @ seen @ halves[k]))
        weight = self.grams.g[np.ix_(self.use, columns[at], columns[at])].sum(axis=0)
        return min(known) < UNKNOWN * len(law.columns) or float(halves[0] @ weight @ halves[1]) > 0.0

    def add(self, model: Model, laws: Sequence[Law], most: int) -> Model:
        """Add the law that foretells best, again and again, whether it is sure or not: `prune` decides on all together.

        Where two laws together foretell much better than one after the other, those two come first: either alone may
        explain little of what both do.
        """
        whole = self.grown(model, laws, most)
        pairs = [
            model.plus(one, np.inf).plus(other, np.inf)
            for one, other in combinations(laws, 2)
            if one.name != other.name
        ]
        best = min(pairs, key=lambda pair: float(self.foretold(pair).sum()), default=None)
        if best is None or most < len(best.laws):
            return whole
        together = self.grown(best, laws, most)
        better = float((self.foretold(whole) - self.foretold(together)).sum())
        return together if better > LEAST_FORETOLD else whole

    def grown(self, model: Model, laws: Sequence[Law], most: int) -> Model:
        """A model with the law that foretells best added, again and again, until it has `most`."""
        while len(model.laws) < most:
            gains = self.gains(model, laws)
            if not gains or gains[0].total < LEAST_FORETOLD:
                break
            model = model.plus(gains[0].law, gains[0].spread)
        return model

    def gains(self, model: Model, laws: Sequence[Law]) -> list[Gain]:
        """What each law that a model has not adds to it, best first."""
        taken = {law.name for law in model.laws}
        return sorted((self.gain(model, law) for law in laws if law.name not in taken), key=lambda one: -one.total)

    def prune(self, model: Model) -> Model:
        """Take out laws that the others make needless, or that are not sure beside them, the weakest first."""
        explained = float((self.foretold(Model(model.base)) - self.foretold(model)).sum())
        enough = min(LEAST_SHARE * explained, NOTICEABLE * self.noise)
        while model.laws:
            gains = [self.gain(model.minus(law), law) for law in model.laws]
            worth = enough if len(gains) > 1 else 0.0
            failing = [one for one in gains if one.total < worth or not self.sure(model, one)]
            if not failing:
                break
            model = model.minus(min(failing, key=lambda one: one.total).law)
        return model

    def sure(self, model: Model, gain: Gain) -> bool:
        """Whether a law of the model passes, with the same sign in both halves if it is a listed one."""
        rest = model.minus(gain.law)
        return self.passes(gain) and (bool(gain.law.family) or self.same_in_both_halves(rest, gain.law))
