"""Davidson's model of games with draws, and its fit to many matrices of counts at once.

With a log strength s a player and one log draw parameter d for all (R. R. Davidson, "On extending the Bradley-Terry
model to accommodate ties in paired comparison experiments", JASA 65, 1970; without draws it is R. A. Bradley and
M. E. Terry, Biometrika 39, 1952):

    P(i beats j) : P(draw) : P(j beats i)  =  exp(s_i) : exp(d + (s_i + s_j) / 2) : exp(s_j)

The logarithm of each term on the right is linear in (s, d), so the negative log likelihood is convex, and strictly
convex with the prior.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def outcome_chances(strengths: Array, draw: Array) -> tuple[Array, Array]:
    """P(i beats j) and P(i and j draw), both (..., players, players), for s (..., players) and d (...)."""
    mine, theirs = strengths[..., :, None], strengths[..., None, :]
    gap = mine - theirs
    drawn = draw[..., None, None] - 0.5 * np.abs(gap)
    best = np.maximum(drawn, 0.0)
    win, tie, loss = np.exp(np.minimum(gap, 0.0) - best), np.exp(drawn - best), np.exp(np.minimum(-gap, 0.0) - best)
    total = win + tie + loss
    return win / total, tie / total


def fit_davidson(wins: Array, draws: Array, centre: Array, prior_sd: float, steps: int = 500) -> tuple[Array, Array]:
    """Maximum a posteriori s (batch, players) and d (batch,) for `wins` and `draws` (batch, players, players).

    The prior of each s is normal with mean `centre`, (batch, players), that of d normal with mean 0, both of standard
    deviation `prior_sd` (natural log units; infinite for plain maximum likelihood, which leaves the mean of s at 0).
    ValueError where the fit does not converge in `steps` steps.

    Damped Newton: a step that changes the outcomes' log odds by up to r is scaled by log(1 + r) / r, which never
    overshoots (Sun and Tran-Dinh, "Generalized self-concordant functions", Mathematical Programming 178, 2019).
    """
    batch, players = wins.shape[:2]
    precision = prior_sd**-2.0
    prior = np.concatenate([centre, np.zeros((batch, 1))], axis=1)
    x = np.zeros((batch, players + 1))
    tolerance = 1e-10 * (1.0 + wins.sum() / batch + draws.sum() / batch)
    for _ in range(steps):
        gradient, curvature = _derivatives(wins, draws, x)
        gradient += precision * (prior - x)
        if np.abs(gradient).max() < tolerance:
            return x[:, :-1], x[:, -1]
        curvature[:, np.arange(players + 1), np.arange(players + 1)] += precision
        curvature[:, :players, :players] += 1.0 if precision == 0.0 else 0.0  # the mean of s, otherwise free
        step = np.linalg.solve(curvature, gradient[..., None])[..., 0]
        reach = np.ptp(step[:, :-1], axis=1) + np.abs(step[:, -1])
        x += step * (np.log1p(reach) / np.maximum(reach, 1e-300))[:, None]
    raise ValueError(f"the rating fit did not converge in {steps} steps; are the counts finite, and is there a prior?")


def _derivatives(wins: Array, draws: Array, x: Array) -> tuple[Array, Array]:
    """Gradient (batch, players + 1) of the log likelihood in (s, d), and its negative Hessian."""
    players = wins.shape[-1]
    win, tie = outcome_chances(x[:, :-1], x[:, -1])
    games = wins + wins.swapaxes(1, 2) + draws
    gradient = np.empty_like(x)
    gradient[:, :-1] = np.sum(wins + 0.5 * draws - games * (win + 0.5 * tie), axis=2)
    gradient[:, -1] = 0.5 * np.sum(draws - games * tie, axis=(1, 2))
    lead = win - win.swapaxes(1, 2)
    # Over the games of i and j: variance of the score (1, 1/2, 0), and its covariance with the indicator of a draw.
    pair = games * (1.0 - tie - lead**2) / 4.0
    cross = -0.5 * games * tie * lead
    curvature = np.zeros((*x.shape, players + 1))
    curvature[:, :-1, :-1] = -pair
    curvature[:, np.arange(players), np.arange(players)] += pair.sum(axis=2)
    curvature[:, :-1, -1] = curvature[:, -1, :-1] = cross.sum(axis=2)
    curvature[:, -1, -1] = 0.5 * np.sum(games * tie * (1.0 - tie), axis=(1, 2))
    return gradient, curvature
