"""The noise model of a camera: by what each measured place of the puck is off.

The error of a coordinate is noise of each frame plus the error of the calibration, a smooth field over the table that
is the same in all frames (`map_error`). The noise of a frame is white noise of the position and of the time stamp
(`segmentation.sensor_noise`), larger where glides are rougher than that, and of a calibrated camera different over the
table (`heteroscedastic`) and correlated from frame to frame (`autocorrelated`).

Who uses what:

- Glides are whitened with all of it (`covariance`), and windows of them weighted by it.
- Contacts get it through the covariance and the drift of the glides' ends (`sliding.problem.States`). Beside these
  `contact.motion` takes the size of the map error as the distance from a wall at which a contact may be the wall's.
- The engine demands that a law moves places by more than the map error, and puts more misfit of a calibrated camera
  down to the sensor, by `Problem.place_error_m`.
- The sensing depends only on whether a camera is calibrated: if so, a scale error must explain nearly all of the lines'
  displacements.
- Segmentation and the encoders know white noise alone, which they estimate before there are glides.
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
    """A glide as it was measured: times `t` (n,) [s], places (n, 2) [m], and the speed (n, 2) [m/s] of each
    coordinate."""

    t: np.ndarray
    place: np.ndarray
    speed: np.ndarray


LEAST, UNCORRELATED = Noise(SEGMENTATION.noise_floor, 0.0), AutocorrelatedNoise()


@dataclass(frozen=True)
class SensorNoise:
    """The noise of the camera of one recording.

    `white`: of the position and of the time stamp; `excess` [1]: the variance in units of it, at least 1;
    `log_variance`: coefficients of `heteroscedastic.std_ratio`, 1, 1/m, 1/m; `map_error_std` [m]: the stated standard
    deviation of the calibration's error along each axis, 0 of a camera that is not calibrated.
    """

    white: Noise = LEAST
    excess: float = 1.0
    log_variance: tuple[float, float, float] = (0.0, 0.0, 0.0)
    autocorrelation: AutocorrelatedNoise = UNCORRELATED
    map_error_std: float = 0.0

    @property
    def calibrated(self) -> bool:
        """Whether the recording states the error of its camera's calibration."""
        return self.map_error_std > 0.0

    def std(self, track: GlideTrack) -> np.ndarray:
        """Standard deviation (n, 2) [m] of the noise of each frame and coordinate of a glide."""
        white = np.sqrt(self.excess) * self.white.std(track.speed)
        return self.autocorrelation.scale * (white * std_ratio(track.place, np.array(self.log_variance)))

    def correlation(self, t: np.ndarray) -> np.ndarray:
        """Correlation (n, n) of the noise of one coordinate at the times `t` (n,) [s] of a segment; with the standard
        deviations on both sides, its covariance."""
        return self.autocorrelation.covariance(t)


def stated_map_error(recording: Recording) -> float:
    """The standard deviation [m] along each axis that a recording states of its calibration's error,
    `camera.place_std_m`; 0 where it states none: its camera is not calibrated."""
    return recording.nominal("camera", "place_std_m") or 0.0


def estimate_sensor_noise(
    white: Noise, excess: float, glides: Sequence[GlideTrack], order: int, map_error_std: float
) -> SensorNoise:
    """Estimate the noise of a camera by what polynomials of an `order` leave of its smooth `glides`.

    The variance over the table and the autocorrelation are estimated of a calibrated camera alone: of another, errors
    of the places themselves, which last as long as forces do, would pass for them. For `white`, `excess` and
    `map_error_std` see `SensorNoise`.
    """
    noise = SensorNoise(white, excess, map_error_std=map_error_std)
    if not noise.calibrated:
        return noise
    at_origin, by_x, by_y = map(float, estimate_log_variance(_excerpts(noise, glides), order))
    noise = replace(noise, log_variance=(at_origin, by_x, by_y))
    found = estimate_autocorrelation(_excerpts(noise, glides), order, _period(glides))
    return replace(noise, autocorrelation=found)


def _excerpts(noise: SensorNoise, glides: Sequence[GlideTrack]) -> list[Excerpt]:
    return [Excerpt(glide.t, glide.place, noise.std(glide)) for glide in glides]


def _period(glides: Sequence[GlideTrack]) -> float:
    """Median time between frames [s]."""
    return float(np.median(np.concatenate([np.diff(glide.t) for glide in glides]))) if glides else 0.0
