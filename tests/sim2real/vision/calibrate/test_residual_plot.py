"""The picture of a calibration: arrows lead from where a point was measured to where it is seen."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import cv2
import numpy as np
import pytest

from sim2real.vision.calibrate.residual_plot import write_plot
from tests.sim2real.vision.calibrate.test_multiview import SETUP, fit

RED = (0x2B, 0x39, 0xC0)  # of a wrong point, blue first


def red(file: Path, off: tuple[float, float]) -> np.ndarray:
    """The mean column and row (2,) of what is red where one point alone is off, and wrong."""
    none = [np.zeros_like(one) for one in fit().off]
    wrong = [np.zeros_like(one) for one in fit().wrong]
    none[0][14], wrong[0][14] = off, True
    write_plot(file, SETUP, replace(fit(), off=none, wrong=wrong), None)
    image = cv2.imread(str(file))
    assert image is not None
    rows, columns = np.nonzero(np.abs(image.astype(int) - RED).sum(axis=2) < 60)
    return np.array([columns.mean(), rows.mean()])


@pytest.mark.parametrize("off, way", [((0.005, 0.0), (0, -1)), ((0.0, 0.005), (-1, 0))])
def test_an_arrow_leads_to_where_a_point_is_seen(tmp_path: Path, off: tuple[float, float], way: tuple[int, int]):
    """x is up in the picture, y to the left."""
    there = red(tmp_path / "there.png", off)
    back = red(tmp_path / "back.png", (-off[0], -off[1]))
    assert (there - back) @ way > 5.0
