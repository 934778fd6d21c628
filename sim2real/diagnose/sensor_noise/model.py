"""The noise model of a camera: the errors of the puck's measured positions.

The error of a coordinate is the noise of each frame plus the error of the calibration, a smooth field over the table
that is the same in all frames (`map_error`). The noise of a frame is white noise of the position and of the time stamp
(`segmentation.sensor_noise`), scaled up if glides show larger residuals. It may be correlated from frame to frame
(`autocorrelated`); for a calibrated camera its variance also varies over the table (`heteroscedastic`).

Its users are:

- Glides are whitened with the full model (`covariance`), and windows of them are weighted by it.
- Contacts use it through the covariance and the drift of the glides' ends (`sliding.problem.States`). `contact.motion`
  also uses the size of the map error as the distance from a wall within which a contact may be the wall's.
- The engine requires that a law moves positions by more than the map error, and tolerates a larger misfit for a
  calibrated camera, by `Problem.place_error_m`.
- The sensing uses only whether a camera is calibrated: if so, a scale error must explain nearly all displacements of
  the lines.
- `compare` predicts glides and contacts with it, without its variation over the table.
- Segmentation and the encoders use white noise alone, which they estimate before glides exist.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np

from sim2real.diagnose.sensor_noise.autocorrelated import AutocorrelatedNoise, Excerpt, estimate_autocorrelation
from sim2real.diagnose.sensor_noise.heteroscedastic import estimate_log_variance, std_ratio
from sim2real.recording.folder import Recording
from sim2real.segmentation.sensor_noise import Noise
from sim2real.segmentation.tuned import SEGMENTATION


class GlideTrack(NamedTuple):
    """A measured glide: times `t` (n,) [s], `place` (n, 2) [m], and the `speed` (n, 2) [m/s] of each coordinate."""

    t: np.ndarray
    place: np.ndarray
    speed: np.ndarray


LEAST, UNCORRELATED = Noise(SEGMENTATION.noise_floor, 0.0), AutocorrelatedNoise()


@dataclass(frozen=True)
class UniformNoise:
    """Noise that is the same everywhere on the table, a `segmentation.sensor_noise.MotionNoise`.

    `white`, with its standard deviation multiplied by `factor` [1], and an autocorrelation.
    """

    white: Noise
    factor: float
    autocorrelation: AutocorrelatedNoise

    def std(self, speed: np.ndarray | float) -> np.ndarray:
        """Return the standard deviation [m] of a coordinate that moves at `speed` [m/s]."""
        return self.factor * self.white.std(speed)

    def correlation(self, t: np.ndarray) -> np.ndarray:
        """Return the correlation (n, n) of one coordinate's noise at the times `t` (n,) [s] of a segment."""
        return self.autocorrelation.covariance(t)


@dataclass(frozen=True)
class SensorNoise:
    """The noise of the camera of one recording.

    `white`: of the position and of the time stamp; `excess` [1]: the variance relative to it, at least 1;
    `log_variance`: coefficients of `heteroscedastic.std_ratio` [1, 1/m, 1/m]; `map_error_std` [m]: the stated standard
    deviation of the calibration error along each axis, 0 for an uncalibrated camera.
    """

    white: Noise = LEAST
    excess: float = 1.0
    log_variance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    autocorrelation: AutocorrelatedNoise = UNCORRELATED
    map_error_std: float = 0.0

    @property
    def calibrated(self) -> bool:
        """Whether the recording states its camera's calibration error."""
        return self.map_error_std > 0.0

    @property
    def uniform(self) -> UniformNoise:
        """The same noise without its variation over the table."""
        return UniformNoise(self.white, float(np.sqrt(self.excess)) * self.autocorrelation.scale, self.autocorrelation)

    def std(self, track: GlideTrack) -> np.ndarray:
        """Return the standard deviation (n, 2) [m] of the noise of each frame and coordinate of a glide."""
        return self.uniform.std(track.speed) * std_ratio(track.place, np.array(self.log_variance))

    def correlation(self, t: np.ndarray) -> np.ndarray:
        """Return the correlation (n, n) of the noise of one coordinate at the times `t` (n,) [s] of a segment."""
        return self.uniform.correlation(t)


def stated_map_error(recording: Recording) -> float:
    """Return the standard deviation [m] of the calibration error along each axis, `camera.place_std_m`.

    It is 0 if the recording states none: its camera is not calibrated.
    """
    return recording.nominal("camera", "place_std_m") or 0.0


def estimate_sensor_noise(
    white: Noise, excess: float, glides: Sequence[GlideTrack], order: int, map_error_std: float
) -> SensorNoise:
    """Estimate the noise of a camera from the residuals of polynomials of order `order` fitted to its smooth `glides`.

    The variance over the table is estimated only for a calibrated camera: otherwise errors of the map would bias it.
    The autocorrelation is estimated for every camera; its time is limited to a few frames (`SENSOR_NOISE`), because
    forces and map errors act for longer. `white`, `excess` and `map_error_std`: see `SensorNoise`.
    """
    noise = SensorNoise(white, excess, map_error_std=map_error_std)
    if noise.calibrated:
        at_origin, by_x, by_y = map(float, estimate_log_variance(_excerpts(noise, glides), order))
        noise = replace(noise, log_variance=(at_origin, by_x, by_y))
    found = estimate_autocorrelation(_excerpts(noise, glides), order, _period(glides))
    return replace(noise, autocorrelation=found)


def _excerpts(noise: SensorNoise, glides: Sequence[GlideTrack]) -> list[Excerpt]:
    return [Excerpt(glide.t, glide.place, noise.std(glide)) for glide in glides]


def _period(glides: Sequence[GlideTrack]) -> float:
    """Return the median time between frames [s]."""
    return float(np.median(np.concatenate([np.diff(glide.t) for glide in glides]))) if glides else 0.0
