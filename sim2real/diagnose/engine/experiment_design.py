"""Experiment design: which kind of segments to record next to discriminate between two laws."""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.normal_equations import NormalEquations
from sim2real.diagnose.engine.tuned import ENGINE


def information(
    equations: NormalEquations, units: np.ndarray, law: Sequence[str], theta: np.ndarray, others: Sequence[str]
) -> np.ndarray:
    """Return how much each unit (units,) discriminates a law from its alternatives.

    It is the squared distance |A theta - C phi|² between the predictions with coefficients `theta` of the columns A
    (`law`) and with the columns C (`others`), where phi is the least-squares solution over all units together.

    The sum over units is the criterion of T-optimal design (Atkinson and Fedorov, Biometrika 62, 1975). It equals
    theta' I theta with the Fisher information I = A'A - A'C (C'C)^-1 C'A of theta beside the nuisance parameters phi.
    """
    g, _ = normal_equations.restricted(equations, equations.columns([*law, *others]), units).whole()
    n = len(law)
    inner, mixed, outer = g[:, :n, :n], g[:, n:, :n], g[:, n:, n:]
    phi = normal_equations.solve_normal(outer.sum(axis=0), mixed.sum(axis=0) @ theta)
    alone = np.einsum("i,uij,j->u", theta, inner, theta)
    shared = np.einsum("i,uij,j->u", phi, mixed, theta)
    return np.maximum(alone - 2.0 * shared + np.einsum("i,uij,j->u", phi, outer, phi), 0.0)


def most_informative(of_units: np.ndarray, kinds: Mapping[str, np.ndarray], unit_name: str) -> str:
    """Return how many more units of which kind are needed, in words; "" if no kind is the most informative, or if they
    are more than anyone records.

    `of_units` (u,): the `information` of each unit; `kinds`: by name, which units (u,) bool are of a kind; `unit_name`:
    what units are called, in the plural.
    """
    means = {name: float(of_units[own].mean()) for name, own in kinds.items() if own.sum() >= ENGINE.fewest_of_kind}
    average = float(of_units.mean()) if len(of_units) else 0.0
    if not means or average <= 0.0:
        return ""
    best = max(means, key=lambda name: means[name])
    if means[best] < ENGINE.richer_kind * average:
        return ""
    more = max(int(np.ceil((ENGINE.discriminating - of_units.sum()) / means[best])), ENGINE.fewest_of_kind)
    if more > ENGINE.most_to_record:
        return ""
    ratio = means[best] / average
    return f"about {more} more {best} {unit_name}, each {ratio:.1f} times as informative as the average one"
