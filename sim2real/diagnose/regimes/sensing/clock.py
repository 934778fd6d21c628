"""Estimate the camera's delay and drift against the encoders' clock from contacts with the robot's mallet.

At a contact the distance between the centres equals the sum of the radii. A delay shifts a moving mallet by velocity
times delay, so each contact with a moving mallet measures the delay, and all of them together the drift. Contacts with
slow mallets and with other directions of motion separate the delay from errors of the radii and of the camera's map.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.regimes.sensing.tuned import CLOCK
from sim2real.segmentation.causes import Geometry
from sim2real.segmentation.mallet_path import MalletPath
from sim2real.segmentation.velocity_jumps import VelocityJump
from sim2real.statistics.robust import ROBUST, t_weights, typical


@dataclass(frozen=True)
class TimedContacts:
    """Contacts with the robot's mallet in one recording.

    `t` (n,) [s] on the camera's clock; `place` (n, 2) [m] of the puck; `impulse` (n, 2): unit vector; `covariance`
    (n, 3, 3) [s, m] of time and place; `launch` (n,); `encoders`: the mallet's path; `radii` [m]: sum of both radii.
    """

    t: np.ndarray
    place: np.ndarray
    impulse: np.ndarray
    covariance: np.ndarray
    launch: np.ndarray
    encoders: MalletPath
    radii: float

    def gaps(self, delay: np.ndarray, rate: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        """Gaps (..., n) [m] between puck and mallet, and unit vectors (..., n, 2) from the mallet, for clocks (...)."""
        away = self.place - self.encoders.at(encoder_time(self.t, delay[..., None], rate[..., None]))
        distance = np.linalg.norm(away, axis=-1)
        return distance - self.radii, away / distance[..., None]


@dataclass(frozen=True)
class Clock:
    """The camera's clock: a frame stamped t shows the encoders' time t / (1 + rate) - delay. `covariance` (2, 2)."""

    delay: float
    rate: float
    covariance: np.ndarray

    def encoder_time(self, t: np.ndarray | float) -> np.ndarray | float:
        """The encoders' time [s] at which a frame stamped `t` [s] was exposed."""
        return encoder_time(t, self.delay, self.rate)


EXACT = Clock(0.0, 0.0, np.zeros((2, 2)))


def encoder_time(t, delay, rate):
    """`Clock.encoder_time` of a clock with this `delay` [s] and `rate` [1]."""
    return t / (1.0 + rate) - delay


def timed_contacts(found: list[VelocityJump], encoders: MalletPath, g: Geometry) -> TimedContacts:
    """Select the velocity jumps that may be contacts with the robot's mallet: nothing else explains them."""
    own = [s for s in found if s.contact.where in ("robot", "nothing near") and _within_reach(s, encoders, g)]
    change = np.array([s.v_out - s.v_in for s in own]).reshape(-1, 2)
    return TimedContacts(
        np.array([s.t for s in own]),
        np.array([s.place for s in own]).reshape(-1, 2),
        change / np.maximum(np.linalg.norm(change, axis=1, keepdims=True), 1e-9),
        np.array([s.covariance[:3, :3] for s in own]).reshape(-1, 3, 3),
        np.array([s.launch for s in own], int),
        encoders,
        g.puck_radius + g.mallet_radius,
    )


def _within_reach(jump: VelocityJump, encoders: MalletPath, g: Geometry) -> bool:
    """Whether the mallet was close enough to the jump for any clock in the range of the search."""
    leeway = CLOCK.longest_delay + CLOCK.largest_rate * abs(jump.t)
    place = encoders.at(np.arange(jump.t - leeway, jump.t + leeway, CLOCK.grid))
    gap = np.linalg.norm(jump.place - place, axis=1) - g.puck_radius - g.mallet_radius
    return bool((np.abs(gap) < 5 * CLOCK.gap_std).any())


def search_clock(tables: list[TimedContacts]) -> tuple[float, float]:
    """The maximum-likelihood delay [s] and rate [1] on a grid; gaps vanish, impulses point along the centres' line."""
    span, most = max(float(np.ptp(each.t)) for each in tables), CLOCK.largest_rate
    rates = np.linspace(-most, most, 2 * max(1, round(most * span / (4 * CLOCK.grid))) + 1)
    delays = np.arange(-CLOCK.longest_delay, CLOCK.longest_delay + CLOCK.grid / 2, CLOCK.grid)
    delay, rate = np.meshgrid(delays, rates, indexing="ij")
    log_likelihood = np.zeros(delay.shape)
    for each in tables:
        gap, away = each.gaps(delay, rate)
        density = np.exp(-0.5 * (gap / CLOCK.gap_std) ** 2) / (CLOCK.gap_std * np.sqrt(2 * np.pi))
        aligned = (away * each.impulse).sum(axis=-1) > CLOCK.least_alignment
        density = np.where(np.isfinite(gap) & aligned, density, 0.0)
        log_likelihood += np.log((1 - CLOCK.outlier_chance) * density + CLOCK.outlier_chance / CLOCK.outlier_range).sum(
            axis=-1
        )
    best = np.unravel_index(int(log_likelihood.argmax()), log_likelihood.shape)
    return float(delay[best]), float(rate[best])


@dataclass(frozen=True)
class ClockFit:
    """A fitted clock.

    `residual`, `std` (n,) [m]: of the gaps of all contacts, nan in holes of the encoder stream; `launch` (n,);
    `touches` (n,): whether the gap is small enough for a contact; `in_fit` (n,): whether the launch was fitted;
    `dispersion`, `freedom`: scatter, in units of the errors, and degrees of freedom of the contacts with both;
    `nuisances` (6,): the fitted nuisance parameters, in the order of `CLOCK.nuisance_std`.
    """

    clock: Clock
    residual: np.ndarray
    std: np.ndarray
    launch: np.ndarray
    touches: np.ndarray
    in_fit: np.ndarray
    dispersion: float
    freedom: int
    nuisances: np.ndarray


def linearise(each: TimedContacts, delay: float, rate: float) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Gaps (n,) [m], their Jacobian (n, 8) by delay, rate and six nuisance parameters, and their variances [m^2]."""
    when = encoder_time(each.t, delay, rate)
    gap, away = each.gaps(np.array(delay), np.array(rate))
    velocity = (each.encoders.at(when + CLOCK.half_span) - each.encoders.at(when - CLOCK.half_span)) / (
        2 * CLOCK.half_span
    )
    closing = (away * velocity).sum(axis=1)
    x, y = each.place.T
    columns = [closing, closing * each.t, -np.ones_like(x), away[:, 0], away[:, 1]]
    columns += [away[:, 0] * x, away[:, 1] * y, away[:, 0] * y]
    row = np.concatenate([-closing[:, None], away], axis=1)
    variance = np.einsum("ni,nij,nj->n", row, each.covariance, row) + each.encoders.noise**2
    return gap, np.stack(columns, axis=1), variance


def fit_clock(
    tables: list[TimedContacts], start: tuple[float, float], free: tuple[bool, bool], skip=()
) -> ClockFit | None:
    """Fit delay and rate, if `free`, and the nuisance parameters by robust least squares, beginning at `start`.

    `skip`: launches left out of the fit, whose residuals are returned too. None if there are too few contacts, or
    none that determine the clock.
    """
    theta = np.concatenate([np.where(free, start, 0.0), np.zeros(len(CLOCK.nuisance_std))])
    prior = 1 / np.square(CLOCK.nuisance_std)
    kept = np.flatnonzero([*free, *np.ones(len(CLOCK.nuisance_std), bool)])
    launch = np.concatenate([each.launch for each in tables])
    in_fit = ~np.isin(launch, skip)
    for _ in range(12):
        rows = [linearise(each, theta[0], theta[1]) for each in tables]
        gap, jacobian, variance = (np.concatenate(part) for part in zip(*rows, strict=True))
        residual = gap + jacobian[:, 2:] @ theta[2:]
        known = np.isfinite(jacobian).all(axis=1) & np.isfinite(variance)  # a hole of the encoders may be near
        touches = known & (np.abs(residual) < CLOCK.largest_gap)
        used = touches & in_fit
        if used.sum() < CLOCK.fewest_contacts:
            return None
        std = np.sqrt(variance)
        weight = t_weights(residual[used] / std[used]) / variance[used]
        rest = jacobian[used].T @ (weight * residual[used])
        normal = (jacobian[used].T * weight) @ jacobian[used]
        rest[2:] += prior * theta[2:]
        normal[2:, 2:] += np.diag(prior)
        if not _determined(normal[np.ix_(kept, kept)]):
            return None
        inverse = np.linalg.inv(normal[np.ix_(kept, kept)])
        step = inverse @ rest[kept]
        theta[kept] -= step
        if np.abs(step).max() < 1e-8:
            break
    freedom = int(used.sum()) - sum(free) - 1
    dispersion = typical(residual[used] / std[used]) * np.sqrt(used.sum() / max(freedom, 1))
    covariance = np.zeros((2, 2))
    covariance[np.ix_(kept[: sum(free)], kept[: sum(free)])] = inverse[: sum(free), : sum(free)]
    covariance *= dispersion**2 * (ROBUST.t_freedom + 3) / (ROBUST.t_freedom + 1)
    clock = Clock(float(theta[0]), float(theta[1]), covariance)
    return ClockFit(clock, residual, std, launch, touches, in_fit, float(dispersion), freedom, theta[2:])


def _determined(normal: np.ndarray) -> bool:
    """Whether normal equations (n, n) determine all numbers: a mallet at rest tells no delay, a single contact with a
    moving one no rate."""
    scale = np.sqrt(np.diag(normal))
    return bool((scale > 0.0).all() and np.linalg.cond(normal / np.outer(scale, scale)) < CLOCK.worst_condition)


def gaps_of_others(
    tables: list[TimedContacts], found: ClockFit
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Gaps [m] of holdout contacts as recorded and under a fitted clock, their errors [m], and their launches, each
    (n,); nan if the mallet was not touched."""
    rows = [linearise(each, found.clock.delay, found.clock.rate) for each in tables]
    gap, jacobian, variance = (np.concatenate(part) for part in zip(*rows, strict=True))
    after = gap + jacobian[:, 2:] @ found.nuisances
    before = np.concatenate([each.gaps(np.array(0.0), np.array(0.0))[0] for each in tables])
    after = np.where(np.abs(after) < CLOCK.largest_gap, after, np.nan)
    return before, after, np.sqrt(variance), np.concatenate([each.launch for each in tables])
