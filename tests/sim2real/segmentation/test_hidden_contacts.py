"""Contacts hidden under a beam: a precise camera; the motion is extrapolated over a tenth of a second."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from puckpilot_env.parameters import TABLE
from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.regimes.contact.motion import ContactMotion, find_contact_motions
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.wall.data import wall_contacts
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import Recording, Stream
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.segments import segment
from tests.sim2real.diagnose.synthetic import LENGTH, META, RADIUS, RATE

DEFAULTS = {row.name: row.default for row in TABLE}
LAUNCHES, NOISE, RESTITUTION = 24, 2e-5, 0.7
HIDDEN = (0.002, 0.07)  # s before and after a contact in which the puck is hidden


def impacts_of(recording: Recording) -> tuple[list[ContactMotion], GlideProblem]:
    segments = segment(recording)
    glides = GlideProblem(glides_of(recording, segments), parameters(recording))
    braking = fit(glides, {"friction": 0.125, "drag": 0.125}, glides.base, np.arange(glides.clusters))
    return find_contact_motions(segments, glides, glides.states(braking)), glides


def recorded(t: np.ndarray, place: np.ndarray) -> Recording:
    """Places (n, 2) [m] at times (n,) [s], observed by a camera with NOISE."""
    x, y = (place + np.random.default_rng(2).normal(0.0, NOISE, place.shape)).T
    nobody = np.full(len(t), np.nan)
    return Recording(
        "shade", META, Stream({"t": t, "puck_x": x, "puck_y": y, "opponent_x": nobody, "opponent_y": nobody})
    )


def slid(place: tuple[float, float], velocity: np.ndarray, times: np.ndarray) -> np.ndarray:
    """Places and velocities (n, 4) at `times` (n,) from 0 on, under the report's law."""

    def motion(_, state: np.ndarray) -> np.ndarray:
        v = state[2:]
        return np.concatenate([v, -(0.125 / np.hypot(*v) + 0.125 * np.hypot(*v)) * v])

    span = (0.0, float(times[-1]))
    return solve_ivp(motion, span, [*place, *velocity], t_eval=times, rtol=1e-10, atol=1e-12).y.T


def shot(number: int, velocity: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Times and places of a shot that meets the wall x1 at about `number` seconds with this velocity, and is not seen
    in the SHADE."""
    u = np.arange(-24, 25) / RATE + 0.3 / RATE
    corner = (LENGTH - RADIUS, 0.4)
    start, speed = np.array(corner) + u[0] * velocity, velocity
    for _ in range(30):  # iterate until it arrives at the corner with the given velocity
        end = slid(tuple(start), speed, np.array([0.0, -u[0]]))[-1]
        start, speed = start + np.array(corner) - end[:2], speed + velocity - end[2:]
    before = slid(tuple(start), speed, np.append(u[u < 0.0] - u[0], -u[0]))[:-1, :2]
    after = slid(corner, RESTITUTION * velocity * (-1.0, 1.0), np.append(0.0, u[u > 0.0]))[1:, :2]
    place = np.concatenate([before, after])
    place[(u > -HIDDEN[0]) & (u < HIDDEN[1])] = np.nan
    return number + u, place


def test_the_stated_errors_of_hidden_bounces_are_correct() -> None:
    """For fast pucks, extrapolation with constant deceleration would give residuals of seven times the noise."""
    rng = np.random.default_rng(4)
    speeds = np.stack([rng.uniform(3.0, 6.0, LAUNCHES), rng.uniform(-1.0, 1.0, LAUNCHES)], axis=1)
    t, place = (np.concatenate(one) for one in zip(*(shot(k, v) for k, v in enumerate(speeds)), strict=True))
    recording = recorded(t, place)
    contact_motions, glides = impacts_of(recording)
    problem = WallProblem(wall_contacts(contact_motions, geometry(recording)), glides.clusters, DEFAULTS)
    assert len(problem.data) > 0.7 * LAUNCHES
    r = problem.residuals({"wall_restitution": RESTITUTION}, (), np.arange(glides.clusters)).r
    assert 0.6 < np.sqrt(np.mean(r**2)) < 1.4


@pytest.mark.parametrize(
    ("off", "stated", "kind"), [(0.06, None, "unexplained"), (0.004, None, "wall"), (0.004, 1.8e-4, "unexplained")]
)
def test_a_hidden_mallet_contact_is_no_contact_with_a_wall_nearby(off: float, stated: float | None, kind: str) -> None:
    """An unrecorded mallet under the beam reverses the puck `off` [m] from the wall; only a calibrated camera detects
    a distance of 4 mm."""
    times, places = [], []
    for k in range(LAUNCHES):
        u = np.arange(-0.4, 0.4, 1.0 / RATE)
        x, y = 0.9 + np.where(u < 0.0, -1.3, 3.9) * u, RADIUS + off + np.where(u < 0.0, -1.6, 0.9) * u
        seen = (u < -0.04) | (u > 0.04)
        times.append(k + u)
        places.append(np.where(seen[:, None], np.stack([x, y], axis=1), np.nan))
    later = np.arange(-0.4, 0.4, 1.0 / RATE) + 0.001  # twice as many wall contacts determine the wall's line
    for k in range(LAUNCHES, 3 * LAUNCHES):
        times.append(k + later)
        y = RADIUS + np.where(later < 0.0, -1.6, 1.1) * later
        places.append(np.stack([1.5 + 0.2 * later, y], axis=1))
    recording = recorded(np.concatenate(times), np.concatenate(places))
    camera = {**META["camera"], "place_std_m": stated}
    recording = replace(recording, meta={**META, "camera": camera})
    assert {contact.where for contact in segment(recording).contacts} == {"y0"}  # by the parabolas on both sides alone
    contact_motions, _ = impacts_of(recording)
    kinds_of_mallet = [one.contact.kind for one in contact_motions if one.contact.t < LAUNCHES - 0.5]
    kinds_of_wall = [one.contact.kind for one in contact_motions if one.contact.t > LAUNCHES - 0.5]
    assert len(kinds_of_mallet) > LAUNCHES // 2 and set(kinds_of_mallet) == {kind}
    assert len(kinds_of_wall) > LAUNCHES // 2 and set(kinds_of_wall) == {"wall"}
