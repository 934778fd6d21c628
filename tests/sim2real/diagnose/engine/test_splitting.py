"""Which pieces tell two laws apart, held against least squares on all residuals at once."""

import numpy as np
import pytest

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.splitting import information, most_telling

UNITS, EACH = 12, 30
NAMES = ("base", "tilt", "warp")


@pytest.fixture(scope="module")
def columns():
    rng = np.random.default_rng(3)
    found = rng.normal(size=(UNITS * EACH, len(NAMES)))
    found[: 6 * EACH, 1] = 2.0 * found[: 6 * EACH, 2]  # in the first half of the units tilt is warp by another name
    found[6 * EACH : 8 * EACH, 1] *= 0.3
    return found


@pytest.fixture(scope="module")
def told(columns):
    unit = np.repeat(np.arange(UNITS), EACH)
    grams = gram.make_grams(NAMES, np.zeros(len(columns)), columns, unit, UNITS)
    return information(grams, np.arange(UNITS), ["tilt"], np.array([0.7]), ["base", "warp"])


def test_a_piece_tells_what_the_best_of_the_other_law_leaves(columns, told):
    says = 0.7 * columns[:, 1]
    best = np.linalg.lstsq(columns[:, [0, 2]], says, rcond=None)[0]
    left = says - columns[:, [0, 2]] @ best
    np.testing.assert_allclose(told, (left.reshape(UNITS, EACH) ** 2).sum(axis=1), rtol=1e-9)


def test_the_kind_that_tells_most_is_asked_for(told):
    third = np.arange(UNITS) // 4 == 2
    words = most_telling(told, {"slow": ~third, "fast": third, "rare": told == told.max()}, "glides")
    ratio = told[third].mean() / told.mean()
    assert words.endswith(f" more fast glides, each of which tells {ratio:.1f} times as much as the average one")


@pytest.mark.parametrize("scale, more", [(1.0, 4), (0.1, 11)])  # (18 - 5.6) / 1.2 = 10.3; of the surer one a few
def test_weak_laws_ask_for_more_pieces(scale, more):
    told = scale * np.array([2.0, 2.0, 2.0, 2.0, 12.0, 12.0, 12.0, 12.0])
    words = most_telling(told, {"slow": told > 6.0 * scale}, "glides")
    assert words.startswith(f"about {more} more slow glides")


def test_where_no_kind_tells_more_none_is_asked_for():
    assert most_telling(np.ones(8), {"slow": np.arange(8) < 4, "fast": np.arange(8) >= 4}, "glides") == ""
    assert most_telling(np.zeros(8), {"slow": np.arange(8) < 4}, "glides") == ""
