"""Null controls: the selected laws, and a search for laws, on data that contain no law by construction."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import replace

import numpy as np

from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.dispersion import estimated_dispersion
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.problem import Units
from sim2real.diagnose.engine.tuned import ENGINE
from sim2real.diagnose.result.result import NullControl

NULL, PERMUTED = "null", "permutation"


def null_controls(
    equations: NormalEquations,
    units: Units,
    model: Model,
    listed: Sequence[Law],
    use: np.ndarray,
    test: np.ndarray,
    least: float = 0.0,
) -> dict[str, NullControl]:
    """Fit `model` to null data of the clusters `use` and predict null data of the clusters `test`.

    Returns, by the kind of data, the rms residual before and after the laws are added. NULL: white sensor noise about
    the baseline; a forward selection and backward elimination among the `listed` laws and those of the model (a wave
    at the length found), with the limit `least` of `ForwardSelection`, should find nothing in it. PERMUTED: the
    baseline's residuals with a random sign for each unit (a randomization test). No search is made there, since these
    residuals are as smooth as the missing law and would resemble other laws.
    """
    laws = list({law.columns: law for law in (*model.laws, *listed)}.values())
    every = Model(model.base, tuple(laws), (1.0,) * len(laws))
    columns, clusters = every.columns(equations)[0], np.arange(equations.clusters)
    inner = normal_equations.restricted(equations, columns, clusters)
    residual = _without(inner, inner.columns(model.base), units, use)
    drawn: Mapping[str, Callable[[np.random.Generator], NormalEquations]] = {
        NULL: lambda rng: _noise(inner, units, rng),
        PERMUTED: lambda rng: _flipped(residual, rng),
    }
    rng, controls = np.random.default_rng(0), {}
    for name, draw in drawn.items():
        data = [draw(rng) for _ in range(ENGINE.null_draws)]
        before, after = np.mean([list(_rms(one, units, model, use, test)) for one in data], axis=0)
        controls[name] = NullControl(float(before), float(after))
        if name == NULL:
            named = sum(_finds_laws(one, units, model.base, laws, use, least) for one in data)
            controls[name] = replace(controls[name], named=named, of=ENGINE.null_draws)
    return controls


def _finds_laws(
    equations: NormalEquations, units: Units, base: tuple[str, ...], laws: Sequence[Law], use: np.ndarray, least: float
) -> bool:
    """Return whether forward selection and backward elimination as in `model_search` leave any law.

    The smooth terms of `model_search` are not searched, nor are laws fitted jointly to the trajectories.
    """
    dispersion = estimated_dispersion(equations, units, base, laws, use)
    selection = ForwardSelection(equations, units, use, dispersion, least)
    grown = selection.add_forward(Model(base), laws, ENGINE.most_listed)
    return bool(selection.eliminate_backward(grown).laws)


def _rms(equations: NormalEquations, units: Units, model: Model, use: np.ndarray, test: np.ndarray) -> Iterator[float]:
    """Yield the rms residual of `test` under the baseline and under the model, both fitted to `use`."""
    fitted, tested = units.of(use), units.of(test)
    for one in (Model(model.base), model):
        columns, ridge = one.columns(equations)
        theta = normal_equations.solve_robustly(equations, columns, fitted, units.freedom[fitted], ridge)
        squares = normal_equations.losses(equations, columns, theta, tested).sum()
        yield float(np.sqrt(max(squares, 0.0) / max(units.freedom[tested].sum(), 1.0)))


def _without(equations: NormalEquations, base: np.ndarray, units: Units, use: np.ndarray) -> NormalEquations:
    """Return the equations of the residuals of all units under the baseline fitted to the clusters `use`."""
    fitted = units.of(use)
    theta = normal_equations.solve_robustly(equations, base, fitted, units.freedom[fitted])
    return normal_equations.moved(equations, base, theta)


def _flipped(equations: NormalEquations, rng: np.random.Generator) -> NormalEquations:
    """Return the equations with a random sign of each unit's residuals."""
    signs = rng.choice((-1.0, 1.0), (equations.clusters, 1))[:, 0]
    return replace(equations, b=np.repeat(signs, np.diff(equations.first_b)) * equations.b)


def _noise(equations: NormalEquations, units: Units, rng: np.random.Generator) -> NormalEquations:
    """Return the equations of white noise e instead of the residuals.

    b = J'e has the covariance J'J; s = e'e is a chi-square, the sum of the parts inside and outside the range of J.
    """
    g = equations.whole()[0]
    value, vector = np.linalg.eigh(g)
    visible = value > ENGINE.rank_tolerance * np.maximum(value[:, -1:], 1e-300)
    e = np.where(visible, rng.normal(size=value.shape), 0.0)
    b = np.einsum("cij,cj->ci", vector, np.sqrt(np.maximum(value, 0.0)) * e)
    rest = np.maximum(units.freedom - visible.sum(axis=1), 0.0)
    s = (e**2).sum(axis=1) + np.where(rest > 0.0, rng.chisquare(np.maximum(rest, 1e-9)), 0.0)
    return normal_equations.packed(equations.names, g, b, s)
