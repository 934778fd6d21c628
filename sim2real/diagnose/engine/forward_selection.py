"""Model selection: forward selection of laws by cross-validation loss, then backward elimination.

A loss is the sum of the units' `group_loss` divided by the dispersion, in units of the noise. It is robust: a few units
that no law explains do not dominate a comparison.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import combinations
from typing import Any

import numpy as np

from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.problem import Units
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.statistics.robust import group_loss


@dataclass(frozen=True)
class Gain:
    """The reduction of the loss when a law is added to the model `beside` it.

    `fitted`: reduction of the fitted loss; `by_launch` (launches,): of the cross-validation loss of each launch;
    `spread`: prior standard deviation of the law's coefficients.
    """

    beside: Model
    law: Law
    fitted: float
    by_launch: np.ndarray
    spread: float

    @property
    def total(self) -> float:
        """The reduction of the cross-validation loss of all launches."""
        return float(self.by_launch.sum())

    @property
    def without_best(self) -> float:
        """The same without the launch that gains most, so that no single launch decides."""
        return self.total - float(self.by_launch.max())


class ForwardSelection:
    """Compares models on the units of the clusters `use`.

    `dispersion`: variance of the noise in units of the sensor's, at least 1; see `dispersion`. `least`:
    reduction of the fitted loss that a law must exceed, for sensors with systematic errors. Losses are cached by model.
    """

    def __init__(
        self, equations: NormalEquations, units: Units, use: np.ndarray, dispersion: float = 1.0, least: float = 0.0
    ) -> None:
        self.equations, self.use, self.dispersion, self.least = equations, units.of(use), dispersion, least
        self._freedom = units.freedom[self.use] * dispersion
        self._launch = np.unique(units.cluster[self.use], return_inverse=True)[1]
        draws = np.random.default_rng(0).integers(self._launches, size=(ENGINE.bootstrap_draws, self._launches))
        self._computed: dict[tuple[Any, ...], Any] = {}
        self._resampled = np.stack([np.bincount(row, minlength=self._launches) for row in draws])

    @property
    def _launches(self) -> int:
        return int(self._launch.max()) + 1

    @property
    def noise_loss(self) -> float:
        """The expected loss of noise alone: the degrees of freedom."""
        return float(self._freedom.sum()) / self.dispersion

    def fitted_loss(self, model: Model) -> float:
        """Return the loss of a model fitted to all units."""
        return self._once("fitted", model, self._fitted_loss)

    def cv_loss(self, model: Model) -> np.ndarray:
        """Return the cross-validation loss (launches,) over units.

        Each unit is predicted by the model fitted to the units of other folds, of any launch: a local effect, such as a
        patch, may occur in a single launch.
        """
        return self._once("units", model, self._cv_loss)

    def launch_cv_loss(self, model: Model) -> np.ndarray:
        """Return the leave-one-launch-out cross-validation loss (launches,)."""
        return self._once("launches", model, self._launch_cv_loss)

    def _once(self, what: str, model: Model, work: Callable[[Model], Any]) -> Any:
        key = (what, *model.key)
        if key not in self._computed:
            self._computed[key] = work(model)
        return self._computed[key]

    def _fitted_loss(self, model: Model) -> float:
        equations, columns, ridge = self._restricted(model)
        units = np.arange(len(self.use))
        theta = normal_equations.solve_robustly(equations, columns, units, self._freedom, ridge)
        squares = normal_equations.losses(equations, columns, theta, units)
        return float(group_loss(squares, self._freedom).sum()) / self.dispersion

    def _cv_loss(self, model: Model) -> np.ndarray:
        folds = np.arange(len(self.use)) % ENGINE.unit_folds
        return self._held_out(model, [folds == fold for fold in np.unique(folds)])

    def _launch_cv_loss(self, model: Model) -> np.ndarray:
        return self._held_out(model, [self._launch == launch for launch in range(self._launches)])

    def _held_out(self, model: Model, folds: Sequence[np.ndarray]) -> np.ndarray:
        """Return the loss (launches,) with the units of each of the `folds` (units,) bool predicted from the others."""
        equations, columns, ridge = self._restricted(model)
        squares = np.zeros(len(self.use))
        for out in folds:
            inside, outside = np.flatnonzero(~out), np.flatnonzero(out)
            theta = normal_equations.solve_robustly(equations, columns, inside, self._freedom[inside], ridge)
            squares[outside] = normal_equations.losses(equations, columns, theta, outside)
        return np.bincount(self._launch, group_loss(squares, self._freedom)) / self.dispersion

    def _restricted(self, model: Model) -> tuple[NormalEquations, np.ndarray, np.ndarray]:
        """The equations of a model's columns and all units, with these columns and their ridge."""
        columns, ridge = model.columns(self.equations)
        part = normal_equations.restricted(self.equations, columns, self.use)
        return part, np.arange(len(columns)), ridge

    def gain(self, model: Model, law: Law) -> Gain:
        """Return the gain of adding `law` to `model`; a smooth term gets the spread that predicts best."""
        before, fitted = self.cv_loss(model), self.fitted_loss(model)
        best: Gain | None = None
        for spread in ENGINE.spreads if law.family else (np.inf,):
            more = model.plus(law, spread)
            gain = Gain(model, law, fitted - self.fitted_loss(more), before - self.cv_loss(more), spread)
            if best is None or gain.total > best.total:
                best = gain
        assert best is not None
        return best

    def gains(self, model: Model, laws: Sequence[Law]) -> list[Gain]:
        """Return the gain of each of the `laws` that are not in the model, the best first."""
        taken = {law.name for law in model.laws}
        return sorted((self.gain(model, law) for law in laws if law.name not in taken), key=lambda one: -one.total)

    def fits(self, gain: Gain) -> bool:
        """Return whether a law lowers the fitted loss by more than chance and by more than `least`.

        Chance is a fixed threshold, plus AIC's 2 for each coefficient, plus 2 log of the number of places searched.
        """
        chance = ENGINE.fit_gain + 2.0 * len(gain.law.columns) + 2.0 * float(np.log(gain.law.searched))
        return gain.fitted > max(chance, self.least)

    def passes(self, gain: Gain) -> bool:
        """Return whether a law fits and predicts better than chance, supported by more than a few launches.

        The gain must be positive in nearly all bootstrap samples of launches, or two launches must each gain far more
        than chance when predicted from the other launches.
        """
        if not self.fits(gain) or gain.total <= ENGINE.cv_gain or gain.without_best <= ENGINE.cv_gain_elsewhere:
            return False
        if self._significantly_positive(gain.by_launch):
            return True
        two = np.argsort(gain.by_launch)[-2:]
        if float(gain.by_launch[two].min()) <= ENGINE.fit_gain:
            return False
        more = gain.beside.plus(gain.law, gain.spread)
        between = self.launch_cv_loss(gain.beside)[two] - self.launch_cv_loss(more)[two]
        return bool(between.min() > ENGINE.fit_gain)

    def inconclusive(self, gain: Gain) -> bool:
        """Return whether a law fits better than chance but does not pass, since few launches support it."""
        return self.fits(gain) and not self.passes(gain)

    def confirmed(self, model: Model) -> bool:
        """Return whether leave-one-launch-out cross-validation confirms a model.

        Its gain over the baseline must be most of the baseline's excess over the noise, a minimum share of the noise,
        and positive in nearly all bootstrap samples of launches.
        """
        baseline = self.launch_cv_loss(Model(model.base))
        gained = baseline - self.launch_cv_loss(model)
        enough = max(
            ENGINE.proving_share * (float(baseline.sum()) - self.noise_loss), ENGINE.share_of_noise * self.noise_loss
        )
        return self._significantly_positive(gained) and float(gained.sum()) > enough

    def _significantly_positive(self, gained: np.ndarray) -> bool:
        """Return whether the sum of the gains (launches,) is positive in nearly all bootstrap samples of launches."""
        return float(np.quantile(self._resampled @ gained, ENGINE.bootstrap_quantile)) > 0.0

    def same_sign_in_halves(self, model: Model, law: Law) -> bool:
        """Return whether odd and even launches give the law coefficients of the same sign.

        The sign is that of the inner product of both by the Fisher information. True also if one half does not
        determine the coefficients.
        """
        columns, ridge = model.plus(law, 1.0).columns(self.equations)
        at = np.isin(columns, self.equations.columns(law.columns))
        halves, sizes = [], []
        for k in (0, 1):
            half = self._launch % 2 == k
            theta = normal_equations.solve_robustly(self.equations, columns, self.use[half], self._freedom[half], ridge)
            halves.append(theta[at])
            information = normal_equations.summed(self.equations, columns[at], self.use[half])[0]
            sizes.append(float(halves[k] @ information @ halves[k]))
        weight = normal_equations.summed(self.equations, columns[at], self.use)[0]
        undetermined = min(sizes) < ENGINE.sign_information * len(law.columns)
        return undetermined or float(halves[0] @ weight @ halves[1]) > 0.0

    def add_forward(self, model: Model, laws: Sequence[Law], most: int) -> Model:
        """Select up to `most` laws forward, significant or not; `eliminate_backward` tests them together.

        The selection starts from the best pair of laws if that ends with a much lower loss, since either law alone may
        explain little of what both explain.
        """
        single = self.grow(model, laws, most)
        pairs = [
            model.plus(one, np.inf).plus(other, np.inf)
            for one, other in combinations(laws, 2)
            if one.name != other.name
        ]
        best = min(pairs, key=lambda pair: float(self.cv_loss(pair).sum()), default=None)
        if best is None or most < len(best.laws):
            return single
        paired = self.grow(best, laws, most)
        better = float((self.cv_loss(single) - self.cv_loss(paired)).sum())
        return paired if better > ENGINE.cv_gain else single

    def grow(self, model: Model, laws: Sequence[Law], most: int) -> Model:
        """Add the law with the greatest cross-validation gain until the model has `most` laws or no gain is enough."""
        while len(model.laws) < most:
            gains = self.gains(model, laws)
            if not gains or gains[0].total < ENGINE.cv_gain:
                break
            model = model.plus(gains[0].law, gains[0].spread)
        return model

    def eliminate_backward(self, model: Model) -> Model:
        """Remove laws that are negligible or not significant beside the others, the least gain first."""
        explained = float((self.cv_loss(Model(model.base)) - self.cv_loss(model)).sum())
        enough = min(ENGINE.share_of_explained * explained, ENGINE.share_of_noise * self.noise_loss)
        while model.laws:
            gains = [self.gain(model.minus(law), law) for law in model.laws]
            least = enough if len(gains) > 1 else 0.0
            failing = [one for one in gains if one.total < least or not self.significant(model, one)]
            if not failing:
                break
            model = model.minus(min(failing, key=lambda one: one.total).law)
        return model

    def significant(self, model: Model, gain: Gain) -> bool:
        """Return whether a law passes and, if it is listed, has the same sign in both halves of the launches."""
        rest = model.minus(gain.law)
        return self.passes(gain) and (bool(gain.law.family) or self.same_sign_in_halves(rest, gain.law))
