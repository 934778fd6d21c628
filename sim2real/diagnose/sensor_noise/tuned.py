"""The tuned numbers of the sensor's noise model."""

from __future__ import annotations

from dataclasses import dataclass

from sim2real.statistics.tuned import tuned

_FIELDS = "python -m tests.sim2real.vision.trial.fields"


@dataclass(frozen=True)
class SensorNoiseNumbers:
    """Autocorrelation, variance over the table, and the map error, in that order."""

    shares: tuple[float, ...] = tuned(
        (0.15, 0.3, 0.45, 0.6, 0.75, 0.9), "1",
        "shares of correlated variance that are tried; a coarser grid whitens badly, a finer one costs time",
        "choice: even steps",
    )  # fmt: skip
    correlation_frames: tuple[float, ...] = tuned(
        (0.7, 1.5, 3.0), "frames",
        "correlation times that are tried; with longer ones forces, which act for longer, pass for noise",
        "choice: factors of two below the time scale of forces",
    )  # fmt: skip
    likelihood_gain: float = tuned(
        12.0, "1",
        "a smaller gain of the log-likelihood names autocorrelation by chance, a larger one misses it",
        "choice: chance gains 5 in one of a hundred recordings",
    )  # fmt: skip
    correlated_frames: int = tuned(
        120, "frames",
        "length of the parts whose likelihood is computed; longer ones cost the third power in time, in shorter ones "
        "polynomials take most of what is correlated",
        "choice: many times the longest correlation time",
    )  # fmt: skip
    outlier_ratio: float = tuned(
        4.0, "1",
        "variance in units of the usual one beyond which a part no longer counts in full, so that no push decides",
        "choice: noise of 70 degrees of freedom hardly ever has twice its variance",
    )  # fmt: skip
    variance_frames: int = tuned(
        40, "frames",
        "length of the parts whose variance is compared over the table; longer ones average over places",
        "choice: leaves 70 degrees of freedom beside two polynomials of order 4",
    )  # fmt: skip
    fewest_parts: int = tuned(
        12, "parts", "fewer leave the variance's three coefficients to chance", "choice: four for each coefficient"
    )
    scoring_rounds: int = tuned(
        30, "1", "Fisher's scoring that does not end", "choice: many more than Newton's method needs"
    )
    scoring_step: float = tuned(
        1e-6, "1", "a larger step of the coefficients ends the scoring too early", "choice: far below their errors"
    )
    slope_information: float = tuned(
        1.0, "m^2",
        "prior information on slopes of zero: without it parts at one place leave them undetermined",
        "choice: little beside the hundreds of degrees of freedom of a recording",
    )  # fmt: skip
    map_orders: int = tuned(
        6, "1", "orders of the map error's polynomials; errors of higher order pass for forces", _FIELDS
    )
    map_low_orders: int = tuned(3, "1", "highest order whose coefficients are large", _FIELDS)
    map_low_std: float = tuned(
        0.61, "1", "std of the coefficients of low order in units of the stated std, 0.05 to 1 there", _FIELDS
    )
    map_high_std: float = tuned(
        0.15, "1", "the same of the higher orders, 0.03 to 0.16 there; the squares of the field add up to 1", _FIELDS
    )


SENSOR_NOISE = SensorNoiseNumbers()
