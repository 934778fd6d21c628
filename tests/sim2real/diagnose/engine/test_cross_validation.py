"""Which laws cross-validation over launches rejects: synthetic effects, fitted to every second launch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine.cross_validation import Selection, select
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import search_model, without, without_laws
from sim2real.diagnose.prove import rms_residual
from sim2real.diagnose.result.regime_result import regime_result
from tests.sim2real.diagnose.engine.linear_problem import DEFAULTS, LAUNCHES, LinearProblem, LinearRegime

USE, OTHERS = np.arange(LAUNCHES)[::2], np.arange(LAUNCHES)[1::2]
TILT = {"tilt_x": 0.02, "tilt_y": -0.03}
DRAG = 0.04


def proved(truth, smooth: bool = False) -> tuple[LinearProblem, Selection]:
    problem = LinearProblem(truth, smooth=smooth)
    return problem, select(problem, search_model(problem, DEFAULTS, USE))


def in_others(value: float, there: float) -> np.ndarray:
    """Return a value for each launch, multiplied by `there` for launches that were not fitted."""
    return value * np.where(np.isin(np.arange(LAUNCHES), OTHERS), there, 1.0)


def test_laws_of_all_launches_are_accepted_unchanged() -> None:
    problem, selected = proved({**TILT, "linear_drag": DRAG})
    assert {law.name for law in selected.found.model.laws} == {"table_tilt", "linear_drag"} == set(selected.without)
    assert selected.rejected == ()
    assert selected.found.law.values == search_model(problem, DEFAULTS, USE).law.values


@pytest.mark.parametrize("smooth", [False, True])
def test_one_outlying_launch_rejects_nothing(smooth: bool) -> None:
    """One of the other launches has ten times the opposite effect: a larger sum of squares than all others."""
    odd = np.ones(LAUNCHES)
    odd[OTHERS[0]] = -10.0
    problem, selected = proved({name: value * odd for name, value in TILT.items()}, smooth)
    without, left = (
        float(np.sum(problem.residuals(values, (), OTHERS).r ** 2)) for values in (DEFAULTS, {**DEFAULTS, **TILT})
    )
    assert left > without and selected.rejected == () and len(selected.found.model.laws) == 1


def test_only_the_absent_law_is_rejected_and_the_other_is_refitted() -> None:
    """The fitted launches have the opposite drag of the others; all have the tilt."""
    truth = {name: 5.0 * value for name, value in TILT.items()} | {"linear_drag": in_others(DRAG, -1.0)}
    problem, selected = proved(truth)
    assert [law.name for law in selected.rejected] == ["linear_drag"]
    assert [law.name for law in selected.found.model.laws] == ["table_tilt"]
    values = selected.found.law.values
    assert values["linear_drag"] == 0.0 and "linear_drag" not in selected.found.law.free
    rows = problem.residuals(values, ("friction", "drag", "tilt_x", "tilt_y"), USE)
    assert np.abs(rows.jacobian.T @ rows.r).max() < 1e-4 * np.abs(rows.jacobian.T @ rows.jacobian).max()


def test_if_a_law_is_rejected_and_most_residual_remains_the_others_are_dropped() -> None:
    """Beside a drag that differs by launch, the tilt explains little of the residuals."""
    truth = {name: 3.0 * value for name, value in TILT.items()} | {"linear_drag": in_others(2.0 * DRAG, -1.0)}
    _, selected = proved(truth)
    assert [law.name for law in selected.rejected] == ["linear_drag"]
    assert [law.name for law in selected.others] == ["table_tilt"]
    assert selected.found.law is selected.found.baseline and selected.without == {}


def test_a_law_without_sensitivity_is_accepted_only_if_all_else_is_clear() -> None:
    problem = LinearProblem(TILT)
    found = search_model(problem, DEFAULTS, USE)
    problem.remove_sensitivity(np.arange(LAUNCHES), ("tilt_x", "tilt_y"))
    accepted = {clear: [law.name for law in select(problem, found, clear).found.model.laws] for clear in (True, False)}
    assert accepted == {True: ["table_tilt"], False: []}


def test_the_model_without_a_law_is_refitted() -> None:
    _problem, selected = proved({**TILT, "linear_drag": DRAG})
    rest = selected.without["table_tilt"]
    assert [law.name for law in rest.model.laws] == ["linear_drag"]
    assert rest.law.values["linear_drag"] == pytest.approx(DRAG, abs=0.01)
    assert [rest.law.values[name] for name in TILT] == [0.0, 0.0]
    assert (
        without_laws(selected.found).law.values
        == search_model(LinearProblem({**TILT, "linear_drag": DRAG}), DEFAULTS, USE).baseline.values
    )


def test_a_law_is_found_beside_coefficients_of_each_launch() -> None:
    """Spins mask a tilt until they are fitted; held-out launches with their own spins show the tilt as well."""
    spins = 2.0 * np.random.default_rng(3).normal(size=LAUNCHES)
    problem = LinearProblem({**TILT, "spin": spins}, spinning=True)
    found = search_model(problem, DEFAULTS, USE)
    selected = select(problem, found)
    assert {law.name for law in selected.found.model.laws} == {
        "table_tilt",
        "side force by spin",
    } and not selected.rejected
    expected = regime_result(LinearRegime(), problem, selected, DEFAULTS)
    assert {one.mechanism for one in expected.findings} == {"table_tilt", "side_force"}
    size = 50.0 * np.hypot(TILT["tilt_x"], TILT["tilt_y"])
    left = {True: selected.found, False: selected.without["table_tilt"]}
    rms = {tilted: rms_residual(problem, one) for tilted, one in left.items()}
    assert rms[True] == pytest.approx(1.0, abs=0.1)
    assert rms[False] == pytest.approx(np.hypot(1.0, size), rel=0.1)


class _Curved(LinearProblem):
    """A smooth term that the simulator can represent: it is linearized anew, so that the law's parameters change."""

    def columns(self, values, free, use, only=()):
        found = super().columns(values, free, use, only)
        shape = Law(
            "push by place", ("tilt_x", "tilt_y"), "position", switch=lambda theta: dict(zip(TILT, theta, strict=True))
        )
        return replace(found, listed=[law for law in found.listed if law.name != "table_tilt"], families=[shape])


def test_the_result_without_a_law_is_one_consistent_fit() -> None:
    """The parameters beside a smooth term are those about which it was linearized."""
    problem = _Curved({**TILT, "linear_drag": DRAG})
    found = search_model(problem, DEFAULTS, USE)
    assert {law.name for law in found.model.laws} == {"linear_drag", "push by place"}
    rest = without(problem, found, next(law for law in found.model.laws if law.name == "linear_drag"))
    assert rest.smooth is not None and rest.law is rest.smooth.law
    assert [law.name for law in rest.model.laws] == ["push by place"] and rest.unlisted is rest.model.laws[0]
