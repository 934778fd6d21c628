"""Which laws a recording asks for: candidates compared by how well they foretell launches that no fit saw."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.gram import Grams

FOLDS = 10
LEAST_FIT = 30.0  # drop of the sum of squares (and 2 more a parameter) that chance does not make
LEAST_FORETOLD = 12.0  # drop of the held-out sum of squares
LEAST_SHARE = 0.05  # of what all laws together explain, or, where they explain far more than the noise,
NOTICEABLE = 0.05  # of the noise's own sum of squares, that a law must explain to be needed
AMBIGUOUS = 9.0  # held-out sums of squares nearer than this do not tell two laws apart
SPREADS = (0.03, 0.3, 3.0)  # tried for the coefficients of a family


@dataclass(frozen=True)
class Law:
    """Columns of a problem's residuals that stand or fall together.

    `name`: a mechanism, or a family of smooth forces; `family` is what it depends on, "" for a mechanism. `start`:
    parameters of a nonlinear law at which its columns were taken.
    """

    name: str
    columns: tuple[str, ...]
    family: str = ""
    start: dict[str, float] = field(default_factory=dict)


@dataclass(frozen=True)
class Gain:
    """What a law adds to others: drop of the sum of squares when fitted, and of each cluster's when foretold."""

    law: Law
    fitted: float
    foretold: np.ndarray
    spread: float

    @property
    def total(self) -> float:
        return float(self.foretold.sum())

    @property
    def without_best(self) -> float:
        """The total without the cluster that gains most: no single launch may carry a discovery."""
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

    def columns(self, grams: Grams) -> tuple[np.ndarray, np.ndarray]:
        """Indices of all columns, and the ridge of each (0 for parameters that have no prior)."""
        names, ridge = list(self.base), [0.0] * len(self.base)
        for law, spread in zip(self.laws, self.spreads, strict=True):
            fresh = [name for name in law.columns if name not in names]
            names += fresh
            ridge += [1.0 / spread**2 if law.family else 0.0] * len(fresh)
        return grams.columns(names), np.array(ridge)


class Chooser:
    """Compares models on the clusters `use` of `grams`; `dispersion` >= 1 is noise beyond the sensor's, in variance."""

    def __init__(self, grams: Grams, use: np.ndarray, dispersion: float = 1.0) -> None:
        self.grams, self.use, self.dispersion = grams, use, dispersion
        self._folds = np.arange(len(use)) % min(FOLDS, len(use))

    def fitted(self, model: Model) -> float:
        """Sum of squares that a model leaves when fitted to all clusters."""
        columns, ridge = model.columns(self.grams)
        theta = gram.solve(self.grams, columns, self.use, ridge)
        return float(gram.losses(self.grams, columns, theta, self.use).sum()) / self.dispersion

    def foretold(self, model: Model) -> np.ndarray:
        """Sum of squares of each cluster under the model fitted to the clusters of the other folds."""
        columns, ridge = model.columns(self.grams)
        loss = np.zeros(len(self.use))
        for fold in range(self._folds.max() + 1):
            out = self._folds == fold
            theta = gram.solve(self.grams, columns, self.use[~out], ridge)
            loss[out] = gram.losses(self.grams, columns, theta, self.use[out])
        return loss / self.dispersion

    def gain(self, model: Model, law: Law) -> Gain:
        """What `law` adds to `model`; a family with the best of SPREADS."""
        before, fitted = self.foretold(model), self.fitted(model)
        best: Gain | None = None
        for spread in SPREADS if law.family else (np.inf,):
            more = model.plus(law, spread)
            gain = Gain(law, fitted - self.fitted(more), before - self.foretold(more), spread)
            if best is None or gain.total > best.total:
                best = gain
        assert best is not None
        return best

    def passes(self, gain: Gain) -> bool:
        """Whether a gain is more than chance, in the fit and on held-out clusters, and not one launch's doing."""
        k = len(gain.law.columns)
        enough = gain.fitted > LEAST_FIT + 2.0 * k and gain.total > LEAST_FORETOLD
        return enough and gain.without_best > 0.0 and bool((gain.foretold > 0.0).mean() > 0.5 or gain.law.family)

    def same_in_both_halves(self, model: Model, law: Law) -> bool:
        """Whether the odd and the even clusters ask for the law with the same sign."""
        columns, ridge = model.plus(law, 1.0).columns(self.grams)
        at = np.isin(columns, self.grams.columns(law.columns))
        halves = [gram.solve(self.grams, columns, self.use[k::2], ridge)[at] for k in (0, 1)]
        weight = self.grams.g[np.ix_(self.use, columns[at], columns[at])].sum(axis=0)
        return float(halves[0] @ weight @ halves[1]) > 0.0

    def add(self, model: Model, laws: Sequence[Law], most: int) -> tuple[Model, list[list[Gain]]]:
        """Add the best law that passes, again and again; also returns each round's gains, best first."""
        rounds = []
        while len(model.laws) < most:
            taken = {law.name for law in model.laws}
            gains = [self.gain(model, law) for law in laws if law.name not in taken]
            gains.sort(key=lambda gain: -gain.total)
            passing = [g for g in gains if self.passes(g) and self.same_in_both_halves(model, g.law)]
            if not passing:
                rounds.append(gains)
                break
            rounds.append(gains)
            model = model.plus(passing[0].law, passing[0].spread)
        return model, rounds

    def prune(self, model: Model) -> Model:
        """Take out laws that the others make needless: little is lost on held-out clusters without them."""
        explained = float((self.foretold(Model(model.base)) - self.foretold(model)).sum())
        noise = NOTICEABLE * float(self.grams.count[self.use].sum())
        while len(model.laws) > 1:
            loss = {
                law.name: float((self.foretold(model.minus(law)) - self.foretold(model)).sum()) for law in model.laws
            }
            weakest = min((law for law in model.laws), key=lambda law: loss[law.name])
            if loss[weakest.name] > max(LEAST_FORETOLD, min(LEAST_SHARE * explained, noise)):
                break
            model = model.minus(weakest)
        return model
