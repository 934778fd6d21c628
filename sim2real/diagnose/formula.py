"""A readable formula for what no listed mechanism explains: the form that the recording itself likes best.

Every form is fitted to what the final law leaves of the recording, the baseline's parameters along with it. The least
BIC says which shapes are worth a fine fit; the simplest of those that explain nearly all that any does is taken, since
no law explains a strong effect to the last digit.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from scipy.optimize import minimize

from sim2real.diagnose.engine import gram
from sim2real.diagnose.finding import Estimate
from sim2real.diagnose.forms import Form, Named
from sim2real.diagnose.interval import reach_of_launches

CHUNK = 60  # columns that are asked for at once
REFINED = 5  # forms whose shape is fitted finely
NEARLY = 0.98  # of the best form's gain, at which a simpler one is as good
OWN = 0.03  # of a law's size that must be other than what the baseline can do
BEYOND = 0.1  # of its range, by which a shape may leave the grid
STEPS = 60  # of the search for a shape


@dataclass(frozen=True)
class Rest:
    """What a law leaves of a recording: residuals `r` (m,) in units of the noise, their columns `base` (m, b) by what
    was fitted, the `cluster` (m,) of each; `respond` takes laws (n, c, k) to the columns (m, k) that they would add to
    what is foretold. `use`: the clusters to fit.
    """

    r: np.ndarray
    base: np.ndarray
    cluster: np.ndarray
    use: np.ndarray
    respond: Callable[[np.ndarray], np.ndarray]


@dataclass(frozen=True)
class Formula:
    """A law in one line, with its `values` and their intervals by name. `moved` (b,): by how much what was fitted
    before moves beside it; `gained`: drop of the sum of squares."""

    form: Form
    words: str
    values: Mapping[str, float]
    parameters: Mapping[str, Estimate]
    moved: np.ndarray
    gained: float


@dataclass(frozen=True)
class Fitted:
    """A form at its best shape: `cost` is its BIC less that of no law, `numbers` how many it has."""

    form: Form
    shape: np.ndarray
    amplitude: np.ndarray
    gained: float
    cost: float

    @property
    def numbers(self) -> int:
        return len(self.shape) + len(self.amplitude)


class Search:
    """Fits forms to what is left."""

    def __init__(self, rest: Rest) -> None:
        self.rest = rest
        self._rows = np.isin(rest.cluster, rest.use)
        self._frame = np.linalg.qr(rest.base[self._rows])[0]
        self._r = self._freed(rest.r[self._rows][:, None])[:, 0]

    def coarse(self, form: Form) -> Fitted:
        """The best of the form's grid."""
        per = form.basis(form.grid[0]).shape[2]
        many = max(CHUNK // per, 1)
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
        """The same form, its shape fitted."""
        if not len(found.shape):
            return found
        form, scale = found.form, np.abs(found.shape) + 1e-6

        low, high = found.form.grid.min(axis=0), found.form.grid.max(axis=0)
        slack = BEYOND * (high - low)
        least = np.where(low > 0.0, np.maximum(low - slack, 0.5 * low), low - slack)  # lengths and times stay positive

        def loss(shape: np.ndarray) -> float:
            if (shape * scale < least).any() or (shape * scale > high + slack).any():
                return 0.0
            return -self._fitted(form, shape * scale, self._columns(form.basis(shape * scale))).gained

        start = found.shape / scale
        simplex = np.vstack([start, *(start + 0.06 * row for row in np.eye(len(start)))])
        options = {"maxfev": STEPS, "xatol": 1e-3, "fatol": 0.1, "initial_simplex": simplex}
        at = minimize(loss, start, method="Nelder-Mead", options=options).x * scale
        better = self._fitted(form, at, self._columns(form.basis(at)))
        return better if better.gained > found.gained else found

    def formula(self, found: Fitted) -> Formula:
        """A fitted form with its numbers and their intervals."""
        named = found.form.named(found.shape, found.amplitude)
        values = {name: value for name, (value, _) in named.items()}
        spread, moved = self._spread(found.form, named)
        near = reach_of_launches(len(self.rest.use)) * np.sqrt(np.diag(spread))
        estimates = {
            name: Estimate(value, value - float(half), value + float(half), unit)
            for (name, (value, unit)), half in zip(named.items(), near, strict=True)
        }
        return Formula(found.form, found.form.words(values), values, estimates, moved, found.gained)

    def _spread(self, form: Form, named: Named) -> tuple[np.ndarray, np.ndarray]:
        """Covariance of the named parameters, from the noise or from the scatter between clusters; and how much the
        baseline's move."""
        rest, values = self.rest, {name: value for name, (value, _) in named.items()}
        here, slopes = form.field(values), []
        for name, value in values.items():
            step = 1e-4 * (abs(value) + 1e-2)
            slopes.append((form.field({**values, name: value + step}) - here) / step)
        both = rest.respond(np.stack([here, *slopes], axis=2))
        jacobian = np.concatenate([-both[:, 1:], rest.base], axis=1)[self._rows]
        left = (rest.r - both[:, 0])[self._rows]
        theta = -np.linalg.lstsq(jacobian, left, rcond=None)[0]
        clusters = np.unique(rest.cluster[self._rows], return_inverse=True)[1]
        count, k = int(clusters.max()) + 1, jacobian.shape[1]
        names = [str(i) for i in range(k)]
        grams = gram.make_grams(names, left, jacobian, clusters, count)
        spread = gram.covariance(grams, np.arange(k), theta, np.arange(count))
        return spread[: len(values), : len(values)], theta[len(values) :]

    def _columns(self, laws: np.ndarray) -> np.ndarray:
        """Columns of laws, nothing where the baseline's parameters stand for all that they do."""
        whole = self.rest.respond(laws)[self._rows]
        own = self._freed(whole)
        own[:, np.linalg.norm(own, axis=0) < OWN * np.linalg.norm(whole, axis=0)] = 0.0
        return own

    def _freed(self, columns: np.ndarray) -> np.ndarray:
        """Columns less what the baseline's parameters could explain of them."""
        return columns - self._frame @ (self._frame.T @ columns)

    def _fitted(self, form: Form, shape: np.ndarray, columns: np.ndarray) -> Fitted:
        right = columns.T @ self._r
        amplitude = gram.solve_normal(columns.T @ columns, right)
        gained = float(right @ amplitude)
        numbers = len(shape) + columns.shape[1]
        return Fitted(form, shape, amplitude, gained, numbers * float(np.log(len(self._r))) - gained)


def no_more(form: Form, shape: np.ndarray) -> Sequence[Form]:
    """No further forms."""
    return ()


def find_formula(
    rest: Rest, forms: Sequence[Form], joined: Callable[[Form, np.ndarray], Sequence[Form]] = no_more
) -> Formula:
    """The form that explains best what is left: of those that explain NEARLY as much as any, the one of fewest numbers.

    `joined`: further forms to try from a fitted one, at its shape.
    """
    search = Search(rest)
    found = [search.coarse(form) for form in forms]
    found += [search.coarse(more) for one in found for more in joined(one.form, one.shape)]
    shaped = sorted((one for one in found if len(one.shape)), key=lambda one: one.cost)
    found += [search.fine(one) for one in shaped[:REFINED]]
    most = max(one.gained for one in found)
    best = min((one for one in found if one.gained >= NEARLY * most), key=lambda one: (one.numbers, one.cost))
    return search.formula(search.fine(best))
