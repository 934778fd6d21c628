"""The choice among candidate models, with losses set by hand."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from sim2real.diagnose.engine.candidate_models import CandidateModel, _remainder, listed_suffice, simplest
from sim2real.diagnose.engine.forward_selection import Gain
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.engine.tuned import ENGINE

BASELINE_LOSS = (
    1000.0 * ENGINE.cv_gain / ENGINE.share_of_explained
)  # so large that the share decides, not the least gain
LAW = LeastSquaresFit({}, (), np.zeros((0, 0)), 0.0, 3, ())
SLACK = ENGINE.share_of_explained * BASELINE_LOSS


def candidate(cv_loss: float, listed: int = 0, family: bool = False) -> CandidateModel:
    laws = tuple(Law(f"law {k}", (f"row {k}",)) for k in range(listed))
    smooth = object() if family else None
    shape = (Law("shape", ("knot",), "position"),) if family else ()
    return CandidateModel(Model((), (*laws, *shape)), LAW, smooth, cv_loss)  # type: ignore[arg-type]


def test_among_equally_good_candidates_the_simplest_is_selected() -> None:
    one, two = candidate(0.5 * SLACK, listed=1), candidate(0.0, listed=2)
    both = candidate(0.2 * SLACK, listed=1, family=True)
    assert simplest([one, two, both], BASELINE_LOSS) is one
    far = candidate(2.0 * SLACK, listed=1)
    assert simplest([far, two, both], BASELINE_LOSS) is two  # both have the same cost, and it predicts better


def test_a_smooth_term_costs_as_much_as_two_laws() -> None:
    listed, alone = candidate(0.3 * SLACK, listed=1), candidate(0.0, family=True)
    assert (listed.cost, alone.cost, candidate(0.0, listed=2, family=True).cost) == (1, 2, 4)
    assert simplest([listed, alone], BASELINE_LOSS) is listed
    assert simplest([candidate(0.3 * SLACK, listed=2), alone], BASELINE_LOSS) is alone


def test_the_slack_is_at_least_the_least_gain() -> None:
    listed, both = candidate(0.9 * ENGINE.cv_gain, listed=1), candidate(0.0, listed=1, family=True)
    baseline_loss = 0.5 * ENGINE.cv_gain / ENGINE.share_of_explained
    assert simplest([listed, both], baseline_loss) is listed
    assert simplest([candidate(1.1 * ENGINE.cv_gain, listed=1), both], baseline_loss) is both


@pytest.mark.parametrize(("laws", "left", "so"), [(1, 0.3, True), (2, 0.3, True), (3, 0.3, False), (1, 0.4, False)])
def test_listed_laws_suffice_if_they_are_few_and_explain_two_thirds(laws: int, left: float, so: bool) -> None:
    """A smooth term alone explains everything; for listed laws a share `left` remains."""
    alone = [candidate(0.0, family=True), candidate(0.5 * BASELINE_LOSS, family=True)]
    assert listed_suffice(candidate(left * BASELINE_LOSS, listed=laws), alone, BASELINE_LOSS) is so


@pytest.mark.parametrize(("gained", "kept"), [(240.0, False), (260.0, True)])
def test_an_added_smooth_term_must_explain_a_quarter_of_the_excess(gained: float, kept: bool) -> None:
    """Listed laws have a loss of 1,200, 200 of it noise, and explain 2,000; a tenth of that is not enough."""
    listed, family = Law("law", ("row",)), Law("shape", ("knot",), "position")
    gain = Gain(Model(()), family, gained, np.array([gained]), 1.0)
    first = SimpleNamespace(cv_loss=lambda model: np.array([1200.0 if model.laws else 3200.0]))
    second = SimpleNamespace(
        gain=lambda model, law: gain, passes=lambda one: True, fitted_loss=lambda model: 1200.0, noise_loss=200.0
    )
    some = SimpleNamespace(families=[family])
    found = _remainder(first, Model((), (listed,), (1.0,)), second, LAW, some)  # type: ignore[arg-type]
    assert (found is gain) is kept


def test_an_empty_model_never_suffices() -> None:
    assert not listed_suffice(candidate(0.0), [candidate(0.5 * BASELINE_LOSS, family=True)], BASELINE_LOSS)
