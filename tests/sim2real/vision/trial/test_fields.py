"""The field that a diagnosis allows a calibration to err by is as calibrations err."""

from __future__ import annotations

import numpy as np

from sim2real.diagnose.sensor_noise.map_error import COEFFICIENT, ORDERS
from tests.sim2real.vision.trial.fields import errors_of


def test_calibrations_err_by_what_a_diagnosis_allows() -> None:
    """Of two of them: 84 coefficients within three standard deviations, and hardly anything beyond the last order."""
    for seed in (101, 102):
        coefficients, off = errors_of(seed)
        order = np.add.outer(np.arange(len(coefficients)), np.arange(len(coefficients)))
        for one, std in zip(ORDERS, COEFFICIENT, strict=True):
            assert np.abs(coefficients[order == one]).max() < 3.0 * std
        assert 0.2 < np.sqrt(np.mean(off**2)) < 1.5
        assert np.abs(coefficients[order > ORDERS[-1]]).max() < 0.1
