"""Which of several ways to explain a problem is taken, by numbers put by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from sim2real.diagnose.engine.choose import LEAST_FORETOLD, LEAST_SHARE, Gain, Model
from sim2real.diagnose.engine.fit import Fit
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.ways import Way, _remainder, simplest, stands_by_itself

NOTHING = 1000.0 * LEAST_FORETOLD / LEAST_SHARE  # loss of the baseline: the share of it decides, not the least
LAW = Fit({}, (), np.zeros((0, 0)), 0.0, 9, 3, ())
SLACK = LEAST_SHARE * NOTHING


def way(foretold: float, listed: int = 0, family: bool = False) -> Way:
    laws = tuple(Law(f"law {k}", (f"row {k}",)) for k in range(listed))
    smooth = object() if family else None
    shape = (Law("shape", ("knot",), "position"),) if family else ()
    return Way(Model((), (*laws, *shape)), LAW, smooth, foretold)  # type: ignore[arg-type]


def test_of_ways_that_foretell_alike_the_one_that_says_least_is_taken() -> None:
    one, two, both = way(0.5 * SLACK, listed=1), way(0.0, listed=2), way(0.2 * SLACK, listed=1, family=True)
    assert simplest([one, two, both], NOTHING) is one
    far = way(2.0 * SLACK, listed=1)
    assert simplest([far, two, both], NOTHING) is two  # as much is said by both, and it foretells better


def test_a_family_counts_as_two_laws_since_it_has_a_shape_as_well() -> None:
    listed, alone = way(0.3 * SLACK, listed=1), way(0.0, family=True)
    assert (listed.cost, alone.cost, way(0.0, listed=2, family=True).cost) == (1, 2, 4)
    assert simplest([listed, alone], NOTHING) is listed
    assert simplest([way(0.3 * SLACK, listed=2), alone], NOTHING) is alone


def test_little_that_is_explained_leaves_a_least_slack() -> None:
    listed, both = way(0.9 * LEAST_FORETOLD, listed=1), way(0.0, listed=1, family=True)
    nothing = 0.5 * LEAST_FORETOLD / LEAST_SHARE
    assert simplest([listed, both], nothing) is listed
    assert simplest([way(1.1 * LEAST_FORETOLD, listed=1), both], nothing) is both


@pytest.mark.parametrize(("laws", "left", "so"), [(1, 0.3, True), (2, 0.3, True), (3, 0.3, False), (1, 0.4, False)])
def test_listed_laws_stand_where_they_are_few_and_explain_two_thirds(laws: int, left: float, so: bool) -> None:
    """A family alone explains all; listed laws leave a share `left`."""
    alone = [way(0.0, family=True), way(0.5 * NOTHING, family=True)]
    assert stands_by_itself(way(left * NOTHING, listed=laws), alone, NOTHING) is so


@pytest.mark.parametrize(("gained", "kept"), [(240.0, False), (260.0, True)])
def test_a_family_on_top_explains_a_quarter_of_what_listed_laws_leave(gained: float, kept: bool) -> None:
    """They leave 1,200, of which 200 are noise, and explain 2,000: a tenth of that is not enough."""
    listed, family = Law("law", ("row",)), Law("shape", ("knot",), "position")
    gain = Gain(Model(()), family, gained, np.array([gained]), 1.0)
    first = SimpleNamespace(foretold=lambda model: np.array([1200.0 if model.laws else 3200.0]))
    second = SimpleNamespace(
        gain=lambda model, law: gain, passes=lambda one: True, fitted=lambda model: 1200.0, noise=200.0
    )
    some = SimpleNamespace(families=[family])
    found = _remainder(first, Model((), (listed,), (1.0,)), second, LAW, some)  # type: ignore[arg-type]
    assert (found is gain) is kept


def test_no_listed_law_stands_for_nothing() -> None:
    assert not stands_by_itself(way(0.0), [way(0.5 * NOTHING, family=True)], NOTHING)
