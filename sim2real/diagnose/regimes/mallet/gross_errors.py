"""Contacts whose measurement went wrong altogether: a single one would spoil the clock's error that all share."""

from __future__ import annotations

import numpy as np

from puckpilot_env.parameters import BY_NAME
from sim2real.diagnose.regimes.contact.data import select_contacts
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.diagnose.regimes.mallet.tuned import MALLET

ROUNDS = 30  # of reweighting, after which least absolute deviations have converged


def without_gross_errors(problem: MalletProblem) -> MalletProblem:
    """The problem without the few contacts whose residuals are far beyond those of a typical contact, whatever the
    restitution and the shared errors are; with all of them, if they are not few."""
    sizes = _robust_sizes(problem)
    gross = sizes > MALLET.gross_error * max(float(np.median(sizes)), 1.0) if len(sizes) else np.zeros(0, bool)
    if not gross.any() or gross.sum() > MALLET.gross_share * len(gross):
        return problem
    return problem.with_contacts(select_contacts(problem.data, ~gross), int(gross.sum()))


def _robust_sizes(problem: MalletProblem) -> np.ndarray:
    """The rms residual (n,) of each contact in units of its noise, with the restitution and the shared errors of least
    absolute deviations: a gross error hardly moves them."""
    contacts, name = len(problem.data), problem.base[0]
    e, step = BY_NAME[name].default, -0.01
    predicted = problem.predicted({name: e})
    by_restitution = (problem.predicted({name: e + step}) - predicted) / step
    r = problem.whitened(problem.observed - predicted)
    columns = np.column_stack([problem.common_errors, -problem.whitened(by_restitution)])
    prior = np.diag([*np.ones(problem.common_errors.shape[1]), 0.0])  # common errors are standard normal
    sizes = np.ones(contacts)
    for _ in range(ROUNDS):
        weight = np.repeat(1.0 / np.maximum(sizes, 1.0), problem.each)[:, None]
        left = columns.T @ (weight * columns) + prior
        theta = np.linalg.lstsq(left, columns.T @ (weight[:, 0] * r), rcond=None)[0]
        sizes = np.sqrt(((r - columns @ theta).reshape(contacts, problem.each) ** 2).mean(axis=1))
    return sizes
