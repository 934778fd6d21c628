"""The mallet figures of a report: an unlisted law as a curve."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.formula.search import Formula
from sim2real.diagnose.regimes.contact.formula import CHANGES, ContactProjection
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.mallet.basis_library import added_shares
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.diagnose.result.result import Curve
from sim2real.statistics.binned import binned, half_band, over, singles


def smooth_curve(problem: MalletProblem, found: SearchResult, formula: Formula, view: ContactProjection) -> Curve:
    """The change of the kept share under an unlisted law, together with its readable formula.

    Data points are the curve plus the residuals of the final law.
    """
    law, component, values = found.unlisted, view.component, found.final.values
    assert law is not None
    speed = problem.data.approach[:, component]
    here = np.abs(speed) > CONTACT.least_speed
    x, speed = view.coordinate[here], speed[here]
    shares = added_shares(problem.data, law)[here]
    added = shares @ found.coefficients
    std = problem.std[here, component] / np.abs(speed)
    predicted = problem.predicted(values)
    observed = (problem.observed - predicted)[here, component] / speed
    moved = dict(zip(found.final.free, formula.moved, strict=True))
    refitted = problem.predicted({**values, **{name: values[name] + float(by) for name, by in moved.items()}})
    by_formula = (refitted - predicted + formula.form.field(formula.values))[here, component] / speed
    points, shape = binned(x, observed, std), over(singles(x), x, added, std)
    covariance = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    half = half_band(shape, std, shares, covariance, found.law.clusters)
    return Curve(
        view.label, CHANGES[component], shape.x, shape.y, shape.y - half, shape.y + half,
        points.x, points.y, points.error, formula=over(shape.members, x, by_formula, std).y,
    )  # fmt: skip
