"""How late the camera stamps its frames against the encoders' clock: where the puck and the robot's mallet meet.

At a blow their centres are as far apart as their radii add up to. Read too late, a moving mallet is elsewhere by its
velocity times the delay, so each blow by a moving mallet measures the delay, and all of them its drift. A constant
error of the radii or of the camera's map differs from a delay in blows of slow and of otherwise moving mallets.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import Geometry
from sim2real.diagnose.encoders import Encoders
from sim2real.diagnose.robust import TAIL, t_weights, typical
from sim2real.diagnose.strikes import Strike

LONGEST = 0.12  # s
FASTEST = 0.001  # 1, the drift of a clock
GRID = 0.0015  # s
ROUGH = 0.0025  # m, by which any gap may be off in the search
CHANCE = 0.05  # that a candidate is no blow of this mallet
FARTHEST = 0.1  # m, the range over which such a candidate's gap would spread
ALIGNED = 0.8  # cosine between the impulse and the line of centres
NUISANCE = (0.0015, 0.0015, 0.0015, 0.004, 0.004, 0.004)  # of radii, offset x, y [m], scale x, y, shear: their spread
SMOOTH = 0.004  # s
TOUCHED = 0.02  # m: a larger gap is none
LEAST = 4  # blows that a fit needs


@dataclass(frozen=True)
class Meetings:
    """Blows by the robot's mallet in one recording: `t` (n,) [s] on the camera's clock, `place` (n, 2) [m] of the puck,
    the impulse's direction `push` (n, 2), `covariance` (n, 3, 3) of time and place, `launch` (n,), and its encoders."""

    t: np.ndarray
    place: np.ndarray
    push: np.ndarray
    covariance: np.ndarray
    launch: np.ndarray
    encoders: Encoders
    touch: float  # m, the sum of the radii

    def gaps(self, delay: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (..., n) [m] of puck and mallet, and directions (..., n, 2) from the mallet, for each clock."""
        away = self.place - self.encoders.at(encoder_time(self.t, delay[..., None], rate[..., None]))
        distance = np.linalg.norm(away, axis=-1)
        return distance - self.touch, away / distance[..., None]


@dataclass(frozen=True)
class Clock:
    """The camera's clock: a frame stamped t shows the encoders' time t / (1 + rate) - delay. `covariance` (2, 2)."""

    delay: float
    rate: float
    covariance: np.ndarray

    def encoder_time(self, t: np.ndarray | float) -> np.ndarray | float:
        return encoder_time(t, self.delay, self.rate)


EXACT = Clock(0.0, 0.0, np.zeros((2, 2)))


def encoder_time(t, delay, rate):
    """The encoders' time [s] of what a frame stamped `t` [s] shows."""
    return t / (1.0 + rate) - delay


def meetings(found: list[Strike], encoders: Encoders, g: Geometry) -> Meetings:
    """The strikes that may be blows of the robot's mallet: those that no wall, no post and no opponent explains."""
    own = [s for s in found if s.hit.where in ("robot", "nothing near") and _within_reach(s, encoders, g)]
    change = np.array([s.v_out - s.v_in for s in own]).reshape(-1, 2)
    return Meetings(
        np.array([s.t for s in own]),
        np.array([s.place for s in own]).reshape(-1, 2),
        change / np.maximum(np.linalg.norm(change, axis=1, keepdims=True), 1e-9),
        np.array([s.covariance[:3, :3] for s in own]).reshape(-1, 3, 3),
        np.array([s.launch for s in own], int),
        encoders,
        g.puck_radius + g.mallet_radius,
    )


def _within_reach(strike: Strike, encoders: Encoders, g: Geometry) -> bool:
    """Whether the mallet was near enough at any time that a clock in the range of the search may call the same."""
    leeway = LONGEST + FASTEST * abs(strike.t)
    place = encoders.at(np.arange(strike.t - leeway, strike.t + leeway, GRID))
    gap = np.linalg.norm(strike.place - place, axis=1) - g.puck_radius - g.mallet_radius
    return bool((np.abs(gap) < 5 * ROUGH).any())


def search(tables: list[Meetings]) -> tuple[float, float]:
    """The likeliest delay [s] and rate on a grid: most blows meet their mallet, pushed along the line of centres."""
    span = max(float(np.ptp(each.t)) for each in tables)
    rates = np.linspace(-FASTEST, FASTEST, 2 * max(1, round(FASTEST * span / (4 * GRID))) + 1)
    delays = np.arange(-LONGEST, LONGEST + GRID / 2, GRID)
    delay, rate = np.meshgrid(delays, rates, indexing="ij")
    height = np.zeros(delay.shape)
    for each in tables:
        gap, away = each.gaps(delay, rate)
        met = np.exp(-0.5 * (gap / ROUGH) ** 2) / (ROUGH * np.sqrt(2 * np.pi))
        met = np.where(np.isfinite(gap) & ((away * each.push).sum(axis=-1) > ALIGNED), met, 0.0)
        height += np.log((1 - CHANCE) * met + CHANCE / FARTHEST).sum(axis=-1)
    best = np.unravel_index(int(height.argmax()), height.shape)
    return float(delay[best]), float(rate[best])


@dataclass(frozen=True)
class Fit:
    """A fitted clock. `residual`, `std` (n,) [m] of all blows, nan where the encoders say nothing; `launch` (n,);
    `met`: those that touched the mallet; `seen`: those of the launches that the fit saw; `spread`: how much wider than
    their errors those that are both scatter; `freedom`: how many more they are than what was fitted; `nuisances`: what
    NUISANCE names, as fitted."""

    clock: Clock
    residual: np.ndarray
    std: np.ndarray
    launch: np.ndarray
    met: np.ndarray
    seen: np.ndarray
    spread: float
    freedom: int
    nuisances: np.ndarray


def linearise(each: Meetings, delay: float, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gaps (n,) [m], their Jacobian (n, 8) by delay, rate and the six nuisances, and their variances (n,) [m^2]."""
    when = encoder_time(each.t, delay, rate)
    gap, away = each.gaps(np.array(delay), np.array(rate))
    velocity = (each.encoders.at(when + SMOOTH) - each.encoders.at(when - SMOOTH)) / (2 * SMOOTH)
    closing = (away * velocity).sum(axis=1)
    x, y = each.place.T
    columns = [closing, closing * each.t, -np.ones_like(x), away[:, 0], away[:, 1]]
    columns += [away[:, 0] * x, away[:, 1] * y, away[:, 0] * y]
    row = np.concatenate([-closing[:, None], away], axis=1)
    variance = np.einsum("ni,nij,nj->n", row, each.covariance, row) + each.encoders.noise**2
    return gap, np.stack(columns, axis=1), variance


def fit(tables: list[Meetings], start: tuple[float, float], free: tuple[bool, bool], skip=()) -> Fit | None:
    """Delay and rate, where `free`, and the nuisances by robust least squares from `start`; None with too few blows.

    `skip`: launches that the fit may not see; their residuals are returned all the same.
    """
    theta = np.concatenate([np.where(free, start, 0.0), np.zeros(len(NUISANCE))])
    prior = 1 / np.square(NUISANCE)
    kept = np.flatnonzero([*free, *np.ones(len(NUISANCE), bool)])
    launch = np.concatenate([each.launch for each in tables])
    seen = ~np.isin(launch, skip)
    for _ in range(12):
        rows = [linearise(each, theta[0], theta[1]) for each in tables]
        gap, jacobian, variance = (np.concatenate(part) for part in zip(*rows, strict=True))
        residual = gap + jacobian[:, 2:] @ theta[2:]
        met = np.abs(residual) < TOUCHED
        used = met & seen
        if used.sum() < LEAST:
            return None
        std = np.sqrt(variance)
        weight = t_weights(residual[used] / std[used]) / variance[used]
        rest = jacobian[used].T @ (weight * residual[used])
        normal = (jacobian[used].T * weight) @ jacobian[used]
        rest[2:] += prior * theta[2:]
        normal[2:, 2:] += np.diag(prior)
        inverse = np.linalg.inv(normal[np.ix_(kept, kept)])
        step = inverse @ rest[kept]
        theta[kept] -= step
        if np.abs(step).max() < 1e-8:
            break
    freedom = int(used.sum()) - sum(free) - 1
    spread = typical(residual[used] / std[used]) * np.sqrt(used.sum() / max(freedom, 1))
    covariance = np.zeros((2, 2))
    covariance[np.ix_(kept[: sum(free)], kept[: sum(free)])] = inverse[: sum(free), : sum(free)]
    covariance *= spread**2 * (TAIL + 3) / (TAIL + 1)
    clock = Clock(float(theta[0]), float(theta[1]), covariance)
    return Fit(clock, residual, std, launch, met, seen, float(spread), freedom, theta[2:])


def missed(tables: list[Meetings], found: Fit) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Gaps [m] of other blows as they were recorded and under a fitted clock, their errors, and their launches, each
    (n,): nan where no mallet was met."""
    rows = [linearise(each, found.clock.delay, found.clock.rate) for each in tables]
    gap, jacobian, variance = (np.concatenate(part) for part in zip(*rows, strict=True))
    after = gap + jacobian[:, 2:] @ found.nuisances
    before = np.concatenate([each.gaps(np.array(0.0), np.array(0.0))[0] for each in tables])
    after = np.where(np.abs(after) < TOUCHED, after, np.nan)
    return before, after, np.sqrt(variance), np.concatenate([each.launch for each in tables])
