"""The model of Davidson for games that can be drawn, and its fit to many tables of counts at once.

With a log strength s a player and one log draw parameter d for all (R. R. Davidson, "On extending the Bradley-Terry
model to accommodate ties in paired comparison experiments", JASA 65, 1970; without draws it is R. A. Bradley and
M. E. Terry, Biometrika 39, 1952):

    P(i beats j) : P(draw) : P(j beats i)  =  exp(s_i) : exp(d + (s_i + s_j) / 2) : exp(s_j)

Each logarithm on the right is linear in (s, d), so minus the log likelihood is convex, and with the prior strictly so.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def outcome_chances(strengths: Array, draw: Array) -> tuple[Array, Array]:
    """P(i beats j) and P(i and j draw), both (..., players, players), of (..., players) s and (...) d."""
    mine, theirs = strengths[..., :, None], strengths[..., None, :]
    gap = mine - theirs
    drawn = draw[..., None, None] - 0.5 * np.abs(gap)
    best = np.maximum(drawn, 0.0)
    win, tie, loss = np.exp(np.minimum(gap, 0.0) - best), np.exp(drawn - best), np.exp(np.minimum(-gap, 0.0) - best)
    total = win + tie + loss
    return win / total, tie / total


def fit(wins: Array, draws: Array, centre: Array, prior_sd: float, steps: int = 500) -> tuple[Array, Array]:
    """Most probable (tables, players) s and (tables,) d for (tables, players, players) `wins` and `draws`.

    The prior of each s is normal with mean `centre`, (tables, players), that of d normal with mean 0, both of standard
    deviation `prior_sd` (natural log units; infinite for plain maximum likelihood, which leaves the mean of s at 0).
    Damped Newton: a step that moves the outcomes' log odds by up to r is cut to log(1 + r) / r of itself, which never
    overshoots (Sun and Tran-Dinh, "Generalized self-concordant functions", Mathematical Programming 178, 2019).
    """
    tables, players = wins.shape[:2]
    precision = prior_sd**-2.0
    prior = np.concatenate([centre, np.zeros((tables, 1))], axis=1)
    x = np.zeros((tables, players + 1))
    tolerance = 1e-10 * (1.0 + wins.sum() / tables + draws.sum() / tables)
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
    raise ValueError(f"the rating fit did not settle in {steps} steps; are the counts finite, and is there a prior?")


def _derivatives(wins: Array, draws: Array, x: Array) -> tuple[Array, Array]:
    """Gradient (tables, players + 1) of the log likelihood in (s, d), and minus its second derivative."""
    players = wins.shape[-1]
    win, tie = outcome_chances(x[:, :-1], x[:, -1])
    games = wins + wins.swapaxes(1, 2) + draws
    gradient = np.empty_like(x)
    gradient[:, :-1] = np.sum(wins + 0.5 * draws - games * (win + 0.5 * tie), axis=2)
    gradient[:, -1] = 0.5 * np.sum(draws - games * tie, axis=(1, 2))
    lead = win - win.swapaxes(1, 2)
    pair = (
        games * (1.0 - tie - lead**2) / 4.0
    )  # variance of a player's score (1, 1/2, 0), over the games with each other
    cross = -0.5 * games * tie * lead  # covariance of the score and of being a draw
    curvature = np.zeros((*x.shape, players + 1))
    curvature[:, :-1, :-1] = -pair
    curvature[:, np.arange(players), np.arange(players)] += pair.sum(axis=2)
    curvature[:, :-1, -1] = curvature[:, -1, :-1] = cross.sum(axis=2)
    curvature[:, -1, -1] = 0.5 * np.sum(games * tie * (1.0 - tie), axis=(1, 2))
    return gradient, curvature
