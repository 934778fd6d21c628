"""The gantry figures of a report: an unlisted law as a curve."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.regimes.gantry.basis_library import baseline_voltages, voltages_of
from sim2real.diagnose.regimes.gantry.formula import GantryProjection
from sim2real.diagnose.regimes.gantry.problem import GantryProblem
from sim2real.diagnose.regimes.gantry.tuned import GANTRY_LAW
from sim2real.diagnose.result.result import Curve
from sim2real.statistics.binned import binned, half_band, over


def smooth_curve(problem: GantryProblem, found: SearchResult, formula: Formula, view: GantryProjection) -> Curve:
    """An unlisted law and its formula over a coordinate, both orthogonal to the baseline's own terms.

    The curve is the ratio of extra volts to driver, by least squares in each bin. There are no data points, because
    the path does not measure volts directly.
    """
    law = found.unlisted
    assert law is not None
    columns = np.concatenate(np.moveaxis(voltages_of(problem.runs, law), 1, 0))
    covariance = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    volts = formula.form.field(formula.values)[:, 0]
    acts = np.concatenate([np.full(len(part), part.any()) for part in np.split(volts, 2)])
    here = acts & (np.abs(view.driver) > GANTRY_LAW.least_driver * np.sqrt(np.mean(view.driver**2)))
    x, driver, by_formula = view.coordinate[here], view.driver[here], _beyond_baseline(problem, volts)[here]
    std = 1.0 / np.abs(driver)  # of the ratio, if all volts have the same error
    rows = columns[here] / driver[:, None]
    shape = binned(x, rows @ found.coefficients, std, GANTRY_LAW.bins)
    half = half_band(shape, std, rows, covariance, found.law.clusters)
    none = np.zeros(0)
    return Curve(
        view.label, f"extra {view.ratio_label}", shape.x, shape.y, shape.y - half, shape.y + half,
        none, none, none, formula=over(shape.members, x, by_formula / driver, std).y,
    )  # fmt: skip


def _beyond_baseline(problem: GantryProblem, volts: np.ndarray) -> np.ndarray:
    """Volts (2 n,) [V], x before y, minus their projection on the baseline's own terms on each axis."""
    rest = []
    for axis, part in enumerate(np.split(volts, 2)):
        baseline = baseline_voltages(problem.runs, axis)
        rest.append(part - baseline @ np.linalg.lstsq(baseline, part, rcond=None)[0])
    return np.concatenate(rest)
