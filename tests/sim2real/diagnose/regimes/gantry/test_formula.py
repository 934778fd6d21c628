"""Formulas of the gantry where a linear step would lead to an axis that rings."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from sim2real.diagnose.regimes.gantry import formula
from sim2real.diagnose.regimes.gantry.problem import GantryProblem, gantry_problem
from sim2real.recording.table_parameters import parameters
from sim2real.study.independent_table.physics.law import Law
from tests.sim2real.diagnose.regimes.gantry.test_gantry import recorded


@pytest.fixture(scope="module")
def problem(tmp_path_factory: pytest.TempPathFactory) -> GantryProblem:
    recording = recorded(tmp_path_factory.mktemp("plain"), Law(), seconds=8.0)
    return gantry_problem([recording], parameters(recording))[0]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("steps", "total"),
    [
        ([0.01, 0.002, 0.001], 0.013),  # of a3, as fractions of its value: all are possible
        ([0.01, 200.0, 0.001], 0.01),  # the second is not
        ([200.0, 0.001, 0.001], 0.0),
    ],
)
def test_steps_are_taken_until_one_leads_to_an_axis_that_rings(
    problem: GantryProblem, monkeypatch: pytest.MonkeyPatch, steps: list[float], total: float
) -> None:
    """A negative a2 is impossible; the parameter b3 moves with it, so that a wrong sum shows."""
    begin = {name: problem.defaults(name) for name in problem.base}

    def move(share: float) -> np.ndarray:
        return np.array([share * begin["a3"], -begin["a2"] if share > 1.0 else 0.0])

    made = iter(SimpleNamespace(form="the form", moved=move(share)) for share in steps[1:])
    monkeypatch.setattr(formula, "_formula_problem", lambda *_: None)
    monkeypatch.setattr(formula, "find_formula", lambda *_: next(made))
    monkeypatch.setattr(formula, "replace", lambda one, **given: given)
    monkeypatch.setattr(formula, "GANTRY_LAW", SimpleNamespace(formula_rounds=2))
    found = SimpleNamespace(final=SimpleNamespace(free=("a3", "a2"), values={**begin, "a3": 0.9 * begin["a3"]}))
    first = SimpleNamespace(form="the form", moved=move(steps[0]), gained=1.0)
    moved = formula._refitted(problem, found, np.arange(1), first, begin)["moved"]  # pyright: ignore
    np.testing.assert_allclose(moved / begin["a3"], [0.1 + total, 0.0], atol=1e-9)
