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
        "shares of correlated variance that are tried; a coarser grid whitens poorly, a finer one costs time",
        "choice: even steps",
    )  # fmt: skip
    correlation_frames: tuple[float, ...] = tuned(
        (0.7, 1.5, 3.0), "frames",
        "correlation times that are tried; longer ones would take forces, which act for longer, for noise",
        "choice: factors of two below the time scale of forces",
    )  # fmt: skip
    likelihood_gain: float = tuned(
        12.0, "1",
        "a smaller gain of the log-likelihood finds autocorrelation by chance, a larger one misses it",
        "choice: noise gains 5 in one of a hundred recordings",
    )  # fmt: skip
    correlated_frames: int = tuned(
        120, "frames",
        "length of the parts whose likelihood is computed; the time grows with its cube; in shorter ones "
        "polynomials absorb most of the correlated noise",
        "choice: many times the longest correlation time",
    )  # fmt: skip
    outlier_ratio: float = tuned(
        4.0, "1",
        "variance relative to the median beyond which a part is clipped, so that no push dominates",
        "choice: a variance estimate of 70 degrees of freedom is hardly ever twice its mean",
    )  # fmt: skip
    variance_frames: int = tuned(
        40, "frames",
        "length of the parts whose variance is compared over the table; longer ones average over places",
        "choice: 70 degrees of freedom remain after two polynomials of order 4",
    )  # fmt: skip
    fewest_parts: int = tuned(
        12,
        "parts",
        "fewer do not determine the three coefficients of the variance",
        "choice: four for each coefficient",
    )
    scoring_rounds: int = tuned(
        30, "1", "Fisher scoring that does not converge", "choice: many more than Newton's method needs"
    )
    scoring_step: float = tuned(
        1e-6, "1", "a larger threshold stops the scoring too early", "choice: far below the standard errors"
    )
    slope_information: float = tuned(
        1.0, "m^2",
        "prior information on slopes of zero: without it parts at one place leave them undetermined",
        "choice: little beside the hundreds of degrees of freedom of a recording",
    )  # fmt: skip
    map_orders: int = tuned(
        6, "1", "number of orders of the map error's polynomials; errors of higher order are taken for forces", _FIELDS
    )
    map_low_orders: int = tuned(3, "1", "highest order whose coefficients are large", _FIELDS)
    map_low_std: float = tuned(
        0.61, "1", "std of the coefficients of low order in units of the stated std, 0.05 to 1 there", _FIELDS
    )
    map_high_std: float = tuned(
        0.15, "1", "the same for higher orders, 0.03 to 0.16 there; the variances of the field add up to 1", _FIELDS
    )


SENSOR_NOISE = SensorNoiseNumbers()
