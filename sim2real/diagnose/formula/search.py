"""The search for a formula: the functional form that best explains the remaining residuals of the final law.

Each form is fitted jointly with the baseline's parameters, which are profiled out: columns and residuals are projected
orthogonally to the baseline's columns. Amplitudes are fitted by linear least squares, nonlinear parameters (the shape)
on a grid. The forms of least BIC get a fine fit. Among the forms that explain nearly as much as the best, the one with
fewest parameters is selected, since no formula explains a strong effect exactly.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.formula.shapes import Form, Named
from sim2real.diagnose.formula.tuned import FORMULA
from sim2real.diagnose.result.result import Estimate
from sim2real.statistics.intervals import reach_of_launches


@dataclass(frozen=True)
class FormulaProblem:
    """The remaining residuals of a law.

    `r` (m,): residuals in units of the noise; `base` (m, b): their derivatives by the fitted parameters; `cluster`
    (m,): the launch of each; `use`: the clusters to fit, with `freedom` degrees of freedom. `respond`: maps k laws (n,
    c, k), values of c components at n instants or contacts, to the columns (m, k) that they add to the prediction.
    """

    r: np.ndarray
    base: np.ndarray
    cluster: np.ndarray
    use: np.ndarray
    freedom: float
    respond: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Formula:
    """A law in one line: its `form`, the line (`words`), its `values` by name and their 95 % intervals (`parameters`).
    `moved` (b,): change of the baseline's parameters in the joint fit; `gained`: reduction of the sum of squares."""

    form: Form
    words: str
    values: Mapping[str, float]
    parameters: Mapping[str, Estimate]
    moved: np.ndarray
    gained: float


@dataclass(frozen=True)
class Fitted:
    """A form at its best `shape` (q,), the nonlinear parameters, and `amplitude` (k,). `gained`: reduction of
    the sum of squares; `bic`: BIC minus that of no law, (q + k) log(m) - gained for m residuals."""

    form: Form
    shape: np.ndarray
    amplitude: np.ndarray
    gained: float
    bic: float

    @property
    def numbers(self) -> int:
        """The number of parameters."""
        return len(self.shape) + len(self.amplitude)


class FormulaSearch:
    """Fits forms to the residuals `rest`, with the baseline's parameters profiled out."""

    def __init__(self, rest: FormulaProblem) -> None:
        self.rest = rest
        self._rows = np.isin(rest.cluster, rest.use)
        self._baseline = np.linalg.qr(rest.base[self._rows])[0]
        self._r = self._projected(rest.r[self._rows][:, None])[:, 0]

    def coarse(self, form: Form) -> Fitted:
        """Return the form at the best shape of its grid."""
        per = form.basis(form.grid[0]).shape[2]
        many = max(FORMULA.columns_at_once // per, 1)
        best: Fitted | None = None
        for first in range(0, len(form.grid), many):
            some = form.grid[first : first + many]
            columns = self._columns(np.concatenate([form.basis(shape) for shape in some], axis=2))
            for k, shape in enumerate(some):
                found = self._fitted(form, shape, columns[:, k * per : (k + 1) * per])
                best = found if best is None or found.gained > best.gained else best
        assert best is not None
        return best

    def fine(self, found: Fitted) -> Fitted:
        """Return the form with its shape fitted by the Nelder-Mead method, near the grid."""
        if not len(found.shape):
            return found
        form, scale = found.form, np.abs(found.shape) + 1e-6
        low, high = found.form.grid.min(axis=0), found.form.grid.max(axis=0)
        slack = FORMULA.beyond_grid * (high - low)
        least = np.where(low > 0.0, np.maximum(low - slack, 0.5 * low), low - slack)  # lengths and times stay positive

        def loss(shape: np.ndarray) -> float:
            if (shape * scale < least).any() or (shape * scale > high + slack).any():
                return 0.0
            return -self._fitted(form, shape * scale, self._columns(form.basis(shape * scale))).gained

        start = found.shape / scale
        simplex = np.vstack([start, *(start + FORMULA.simplex_size * row for row in np.eye(len(start)))])
        options = {"maxfev": FORMULA.simplex_steps, "xatol": 1e-3, "fatol": 0.1, "initial_simplex": simplex}
        at = minimize(loss, start, method="Nelder-Mead", options=options).x * scale
        better = self._fitted(form, at, self._columns(form.basis(at)))
        return better if better.gained > found.gained else found

    def formula(self, found: Fitted) -> Formula:
        """Return a fitted form with parameters and 95 % intervals, with Student's t for the number of launches."""
        named = found.form.named(found.shape, found.amplitude)
        values = {name: value for name, (value, _) in named.items()}
        covariance, moved = self._covariance(found.form, named)
        halves = reach_of_launches(len(self.rest.use)) * np.sqrt(np.diag(covariance))
        estimates = {
            name: Estimate(value, value - float(half), value + float(half), unit)
            for (name, (value, unit)), half in zip(named.items(), halves, strict=True)
        }
        return Formula(found.form, found.form.words(values), values, estimates, moved, found.gained)

    def _covariance(self, form: Form, named: Named) -> tuple[np.ndarray, np.ndarray]:
        """Return the covariance of the named parameters and the changes of the baseline's parameters.

        Both are from a joint linear least-squares fit about the fitted form, with derivatives by finite differences;
        see `normal_equations.covariance`.
        """
        rest, values = self.rest, {name: value for name, (value, _) in named.items()}
        here, slopes = form.field(values), []
        for name, value in values.items():
            step = 1e-4 * (abs(value) + 1e-2)
            slopes.append((form.field({**values, name: value + step}) - here) / step)
        both = rest.respond(np.stack([here, *slopes], axis=2))
        jacobian = np.concatenate([-both[:, 1:], rest.base], axis=1)[self._rows]
        residuals = (rest.r - both[:, 0])[self._rows]
        theta = -np.linalg.lstsq(jacobian, residuals, rcond=None)[0]
        clusters = np.unique(rest.cluster[self._rows], return_inverse=True)[1]
        count, k = int(clusters.max()) + 1, jacobian.shape[1]
        names = [str(i) for i in range(k)]
        equations = normal_equations.make_equations(names, residuals, jacobian, clusters, count)
        covariance = normal_equations.covariance(equations, np.arange(k), theta, np.arange(count), rest.freedom)
        return covariance[: len(values), : len(values)], theta[len(values) :]

    def _columns(self, laws: np.ndarray) -> np.ndarray:
        """Return columns of laws with the baseline profiled out, zeros where it can fit nearly all of a law."""
        columns = self.rest.respond(laws)[self._rows]
        own = self._projected(columns)
        own[:, np.linalg.norm(own, axis=0) < FORMULA.own_share * np.linalg.norm(columns, axis=0)] = 0.0
        return own

    def _projected(self, columns: np.ndarray) -> np.ndarray:
        """Return columns minus their projection onto the baseline's columns."""
        return columns - self._baseline @ (self._baseline.T @ columns)

    def _fitted(self, form: Form, shape: np.ndarray, columns: np.ndarray) -> Fitted:
        right = columns.T @ self._r
        amplitude = normal_equations.solve_normal(columns.T @ columns, right)
        gained = float(right @ amplitude)
        numbers = len(shape) + columns.shape[1]
        return Fitted(form, shape, amplitude, gained, numbers * float(np.log(len(self._r))) - gained)


def no_more(form: Form, shape: np.ndarray) -> Sequence[Form]:
    """Return no further forms."""
    return ()


def find_formula(
    rest: FormulaProblem,
    forms: Sequence[Form],
    joined: Callable[[Form, np.ndarray], Sequence[Form]] = no_more,
) -> Formula:
    """Find the formula that best explains the residuals `rest`.

    Among the forms that gain nearly as much as the best, it has the fewest parameters, then the least BIC. `forms`:
    candidates; `joined`: returns further candidates for a fitted form at its shape.
    """
    search = FormulaSearch(rest)
    found = [search.coarse(form) for form in forms]
    found += [search.coarse(more) for one in found for more in joined(one.form, one.shape)]
    shaped = sorted((one for one in found if len(one.shape)), key=lambda one: one.bic)
    found += [search.fine(one) for one in shaped[: FORMULA.refined]]
    most = max(one.gained for one in found)
    good = [one for one in found if one.gained >= FORMULA.nearly_all * most]
    best = min(good, key=lambda one: (one.numbers, one.bic))
    return search.formula(search.fine(best))
