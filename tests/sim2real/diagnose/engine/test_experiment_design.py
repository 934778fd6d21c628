"""Which segments discriminate between two laws, compared with least squares on all residuals at once."""

import numpy as np
import pytest

from sim2real.diagnose.engine.experiment_design import information, most_informative
from sim2real.diagnose.engine.linear import normal_equations

UNITS, EACH = 12, 30
NAMES = ("base", "tilt", "warp")


@pytest.fixture(scope="module")
def columns():
    rng = np.random.default_rng(3)
    found = rng.normal(size=(UNITS * EACH, len(NAMES)))
    found[: 6 * EACH, 1] = 2.0 * found[: 6 * EACH, 2]  # in the first half of the units tilt and warp are proportional
    found[6 * EACH : 8 * EACH, 1] *= 0.3
    return found


@pytest.fixture(scope="module")
def of_units(columns):
    unit = np.repeat(np.arange(UNITS), EACH)
    equations = normal_equations.make_equations(NAMES, np.zeros(len(columns)), columns, unit, UNITS)
    return information(equations, np.arange(UNITS), ["tilt"], np.array([0.7]), ["base", "warp"])


def test_the_information_of_a_segment_is_the_residual_of_the_best_other_law(columns, of_units):
    predicted = 0.7 * columns[:, 1]
    best = np.linalg.lstsq(columns[:, [0, 2]], predicted, rcond=None)[0]
    left = predicted - columns[:, [0, 2]] @ best
    np.testing.assert_allclose(of_units, (left.reshape(UNITS, EACH) ** 2).sum(axis=1), rtol=1e-9)


def test_the_most_informative_kind_is_advised(of_units):
    third = np.arange(UNITS) // 4 == 2
    words = most_informative(of_units, {"slow": ~third, "fast": third, "rare": of_units == of_units.max()}, "glides")
    ratio = of_units[third].mean() / of_units.mean()
    assert words.endswith(f" more fast glides, each {ratio:.1f} times as informative as the average one")


@pytest.mark.parametrize(
    "scale, more", [(1.0, 4), (0.1, 11)]
)  # (18 - 5.6) / 1.2 = 10.3; the more significant one needs few
def test_weak_laws_need_more_segments(scale, more):
    of_units = scale * np.array([2.0, 2.0, 2.0, 2.0, 12.0, 12.0, 12.0, 12.0])
    words = most_informative(of_units, {"slow": of_units > 6.0 * scale}, "glides")
    assert words.startswith(f"about {more} more slow glides")


def test_where_no_kind_is_more_informative_none_is_advised():
    assert most_informative(np.ones(8), {"slow": np.arange(8) < 4, "fast": np.arange(8) >= 4}, "glides") == ""
    assert most_informative(np.zeros(8), {"slow": np.arange(8) < 4}, "glides") == ""


def test_what_nobody_records_is_not_advised():
    assert (
        most_informative(1e-6 * np.array([2.0, 2.0, 12.0, 12.0, 12.0, 12.0]), {"fast": np.arange(6) > 1}, "glides")
        == ""
    )
