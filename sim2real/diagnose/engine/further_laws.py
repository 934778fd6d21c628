"""Listed laws that appear only beside others, about which the design matrix is linearized anew."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.engine.backward_elimination import eliminated, fits_typical_launch, has_misfit
from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.law import Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.engine.tuned import ENGINE


def with_further_laws(
    problem: Problem,
    baseline: LeastSquaresFit,
    listed: Model,
    law: LeastSquaresFit,
    screen: DesignMatrix,
    selection: ForwardSelection,
    use: np.ndarray,
) -> tuple[Model, LeastSquaresFit]:
    """Return the `listed` laws and their joint fit `law`, or more and other laws that explain a typical launch.

    About the baseline, a large law is far from linear and hides a smaller one, or another form of itself; about its
    own fit it does not. If a typical launch remains unexplained all the same, further laws may only approximate one
    that is not listed, and none is added.

    `screen`: the design matrix about the baseline, from which `selection` chose the listed laws; `use` (k,): the
    fitted clusters.
    """
    if not listed.laws or not has_misfit(problem, baseline, law, use):
        return listed, law
    columns = problem.columns(law.values, law.free, use)
    about = ForwardSelection(columns.equations, problem.units, use, selection.dispersion, selection.least)
    here = Model(law.free)
    others = [
        one for one in columns.listed
        if not set(one.rows) & set(law.free) and (not one.start or one in screen.listed)  # which fits start from
    ]  # fmt: skip
    grown = about.eliminate_backward(about.grow(here, others, ENGINE.most_listed - len(listed.laws)))
    if not grown.laws:
        return listed, law
    model = listed
    for further in grown.laws:
        model = model.plus(further, np.inf)
    model, joint = eliminated(problem, baseline, model, screen, use)
    if any(one not in listed.laws for one in model.laws) and fits_typical_launch(problem, joint, use):
        return model, joint
    return listed, law
