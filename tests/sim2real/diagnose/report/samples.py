"""A sample curve and sample residuals for figures."""

import numpy as np

from sim2real.diagnose.result.result import Curve, Mismatch

RANGES = ((-180, 180), (-0.02, 0.02), (-0.03, 0.01), (-0.01, 0.03), (-170, 170), (-0.02, 0.02), (0.001, 0.001))
X, Y, LOW, HIGH, DATA_X, DATA_Y, ERROR = (np.linspace(low, high, 9) for low, high in RANGES)
CURVE = Curve("heading [°]", "acceleration [m/s²]", X, Y, LOW, HIGH, DATA_X, DATA_Y, ERROR)


def mismatch_sample(n: int = 60) -> Mismatch:
    """Return accelerations of `n` segments of motion that a law reduces to zero."""
    rng = np.random.default_rng(0)
    before, after = rng.normal(0.02, 0.01, (n, 2)), rng.normal(0.0, 0.01, (n, 2))
    axis = np.stack([np.cos(k := rng.uniform(-3, 3, n)), np.sin(k)], axis=1)
    by = {"speed [m/s]": rng.uniform(0, 2, n), "time [s]": np.full(n, np.nan)}
    place = rng.uniform((0, 0), (2, 1), (n, 2))
    std = np.full((n, 2), 0.01)
    return Mismatch(
        "segments", "acceleration", "m/s²", ("along", "left"), before, after, std, by, place, axis, (2.0, 1.0)
    )
