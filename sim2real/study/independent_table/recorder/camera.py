"""A simulated camera: times of exposure, observed positions, and errors."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder import film
from sim2real.study.independent_table.recorder.scene import FINE, Scene


@dataclass(frozen=True)
class Camera:
    """Noise of each coordinate, jitter of exposures and arrivals, and shares of frames that are held, dropped or wild;
    and the errors of a calibrated camera beside the table (`sim2real.study.independent_table.recorder.film`)."""

    rate: float = 120.0  # Hz
    noise: float = 0.0005  # m
    jitter: float = 0.0001  # s, of the exposures, which the stamps show
    arrival: float = 0.0  # s, of stamps that are arrivals
    held: float = 0.0  # of the frames repeat the last position
    dropped: float = 0.0  # of the frames see no puck
    wild: float = 0.0  # of the frames are wrong by centimetres
    wild_by: float = 0.05  # m, the size of such an error
    correlation_time: float = 0.0  # s, of the autocorrelated part of the noise; 0: the noise is white
    correlated: float = 0.75  # share of the noise's variance that is autocorrelated
    place_error: float = 0.0  # m, stated standard deviation of the calibration's error
    calibration: int = 0  # seed of the calibration's error
    beam: float = 0.0  # m on either side of the robot's mallet, along the table, that its gantry hides


def look_up(t: np.ndarray, path: np.ndarray) -> np.ndarray:
    """Positions (m, 2) at times t (m,) on a path (n, 2) sampled every FINE seconds; NaN outside and next to NaN."""
    at = t / FINE
    left = np.clip(np.floor(at).astype(int), 0, len(path) - 2)
    share = (at - left)[:, None]
    seen = path[left] + share * (path[left + 1] - path[left])
    seen[(at < 0.0) | (at > len(path) - 1)] = np.nan
    return seen


def see(law: Law, camera: Camera, scene: Scene, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Time stamps (m,), observed positions of the puck (m, 2) and of the opponent's mallet (m, 2; NaN without one)."""
    seconds = len(scene.t) * FINE
    taken = np.arange(1, int(seconds * camera.rate)) / camera.rate
    taken = taken + np.clip(camera.jitter * rng.standard_normal(len(taken)), -0.3 / camera.rate, 0.3 / camera.rate)
    stamps = (taken + law.camera_delay) * (1.0 + law.camera_clock)
    paths = [scene.puck, scene.mallets[1] if len(scene.mallets) > 1 else np.full_like(scene.puck, np.nan)]
    puck, opponent = (distort(law, look_up(taken, path)) for path in paths)
    if camera.place_error:
        puck = puck + camera.place_error * film.field(puck / (law.length, law.width), camera.calibration)
    puck = puck + camera.noise * film.noise(rng, taken, camera.correlation_time, camera.correlated)
    opponent = opponent + camera.noise * rng.standard_normal(opponent.shape)
    if camera.beam and len(scene.mallets):
        puck[np.abs(puck[:, 0] - look_up(taken, scene.mallets[0])[:, 0]) < camera.beam] = np.nan
    fate = rng.uniform(size=len(taken))
    heading = rng.uniform(0.0, 2.0 * np.pi, len(taken))
    wild = fate < camera.wild
    puck[wild] += camera.wild_by * np.stack([np.cos(heading[wild]), np.sin(heading[wild])], axis=1)
    fate -= camera.wild
    puck[(fate >= 0.0) & (fate < camera.dropped)] = np.nan
    fate -= camera.dropped
    for i in np.flatnonzero((fate >= 0.0) & (fate < camera.held)):
        if i > 0:
            puck[i] = puck[i - 1]
    if camera.arrival:
        stamps += np.clip(camera.arrival * rng.standard_normal(len(taken)), -0.4 / camera.rate, 0.4 / camera.rate)
    return stamps, puck, opponent


def distort(law: Law, seen: np.ndarray) -> np.ndarray:
    """Apply the camera's map error: stretch and shear about the origin."""
    x, y = seen[:, 0], seen[:, 1]
    return np.stack([(1.0 + law.camera_scale_x) * x + law.camera_shear * y, (1.0 + law.camera_scale_y) * y], axis=1)
