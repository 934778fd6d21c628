"""Which laws launches that no fit saw reject, and which not: truths put by hand, found in every second launch."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine.cross_validation import Selection, select
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import bare, search_model, without
from sim2real.diagnose.prove import left_of
from sim2real.diagnose.result.regime_result import regime_result
from tests.sim2real.diagnose.engine.linear_problem import LAUNCHES, SHIPPED, LinearProblem, LinearRegime

USE, OTHERS = np.arange(LAUNCHES)[::2], np.arange(LAUNCHES)[1::2]
TILT = {"tilt_x": 0.02, "tilt_y": -0.03}
DRAG = 0.04


def proved(truth, likeness: bool = False) -> tuple[LinearProblem, Selection]:
    problem = LinearProblem(truth, likeness=likeness)
    return problem, select(problem, search_model(problem, SHIPPED, USE))


def in_others(value: float, there: float) -> np.ndarray:
    """A number for each launch, of which those in which nothing was looked for have a share."""
    return value * np.where(np.isin(np.arange(LAUNCHES), OTHERS), there, 1.0)


def test_what_holds_stands_as_it_was_found() -> None:
    problem, said = proved({**TILT, "linear_drag": DRAG})
    assert {law.name for law in said.found.model.laws} == {"table_tilt", "linear_drag"} == set(said.without)
    assert said.rejected == ()
    assert said.found.law.values == search_model(problem, SHIPPED, USE).law.values


@pytest.mark.parametrize("likeness", [False, True])
def test_one_odd_launch_rejects_nothing(likeness: bool) -> None:
    """Of the other launches one is pushed the other way ten times as hard: more squares than all others have."""
    odd = np.ones(LAUNCHES)
    odd[OTHERS[0]] = -10.0
    problem, said = proved({name: value * odd for name, value in TILT.items()}, likeness)
    without, left = (
        float(np.sum(problem.residuals(values, (), OTHERS).r ** 2)) for values in (SHIPPED, {**SHIPPED, **TILT})
    )
    assert left > without and said.rejected == () and len(said.found.model.laws) == 1


def test_a_law_that_is_not_there_goes_alone_and_the_other_is_fitted_anew() -> None:
    """The drag of the fitted launches is the opposite of that of the others; the tilt is in all."""
    truth = {name: 5.0 * value for name, value in TILT.items()} | {"linear_drag": in_others(DRAG, -1.0)}
    problem, said = proved(truth)
    assert [law.name for law in said.rejected] == ["linear_drag"]
    assert [law.name for law in said.found.model.laws] == ["table_tilt"]
    values = said.found.law.values
    assert values["linear_drag"] == 0.0 and "linear_drag" not in said.found.law.free
    rows = problem.residuals(values, ("friction", "drag", "tilt_x", "tilt_y"), USE)
    assert np.abs(rows.jacobian.T @ rows.r).max() < 1e-4 * np.abs(rows.jacobian.T @ rows.jacobian).max()


def test_with_a_law_rejected_and_most_left_the_others_go_as_well() -> None:
    """Beside a drag that is another one in each, the tilt explains little of what launches have."""
    truth = {name: 3.0 * value for name, value in TILT.items()} | {"linear_drag": in_others(2.0 * DRAG, -1.0)}
    _, said = proved(truth)
    assert [law.name for law in said.rejected] == ["linear_drag"]
    assert [law.name for law in said.others] == ["table_tilt"]
    assert said.found.law is said.found.baseline and said.without == {}


def test_what_launches_do_not_feel_stands_only_where_all_else_is_clear() -> None:
    problem = LinearProblem(TILT)
    found = search_model(problem, SHIPPED, USE)
    problem.feel_nothing(np.arange(LAUNCHES), ("tilt_x", "tilt_y"))
    stands = {clear: [law.name for law in select(problem, found, clear).found.model.laws] for clear in (True, False)}
    assert stands == {True: ["table_tilt"], False: []}


def test_what_is_fitted_without_a_law_is_found_without_it() -> None:
    _problem, said = proved({**TILT, "linear_drag": DRAG})
    rest = said.without["table_tilt"]
    assert [law.name for law in rest.model.laws] == ["linear_drag"]
    assert rest.law.values["linear_drag"] == pytest.approx(DRAG, abs=0.01)
    assert [rest.law.values[name] for name in TILT] == [0.0, 0.0]
    assert (
        bare(said.found).law.values
        == search_model(LinearProblem({**TILT, "linear_drag": DRAG}), SHIPPED, USE).baseline.values
    )


def test_a_law_shows_beside_numbers_that_each_launch_has_of_its_own() -> None:
    """Spins hide a tilt until they are known; the others, whose spins are not, show the tilt by theirs."""
    spins = 2.0 * np.random.default_rng(3).normal(size=LAUNCHES)
    problem = LinearProblem({**TILT, "spin": spins}, spinning=True)
    found = search_model(problem, SHIPPED, USE)
    said = select(problem, found)
    assert {law.name for law in said.found.model.laws} == {"table_tilt", "side force by spin"} and not said.rejected
    expected = regime_result(LinearRegime(), problem, said, SHIPPED)
    assert {one.mechanism for one in expected.findings} == {"table_tilt", "side_force"}
    size = 50.0 * np.hypot(TILT["tilt_x"], TILT["tilt_y"])
    left = {True: said.found, False: said.without["table_tilt"]}
    rms = {tilted: left_of(problem, one) for tilted, one in left.items()}
    assert rms[True] == pytest.approx(1.0, abs=0.1)
    assert rms[False] == pytest.approx(np.hypot(1.0, size), rel=0.1)


class _Curved(LinearProblem):
    """A likeness that the simulator has: its columns are taken anew about it, so that its law's numbers move."""

    def columns(self, values, free, use):
        found = super().columns(values, free, use)
        shape = Law(
            "push by place", ("tilt_x", "tilt_y"), "position", switch=lambda theta: dict(zip(TILT, theta, strict=True))
        )
        return replace(found, listed=[law for law in found.listed if law.name != "table_tilt"], families=[shape])


def test_what_is_left_without_a_law_is_one_fit() -> None:
    """The numbers beside a family are those about which its columns were taken."""
    problem = _Curved({**TILT, "linear_drag": DRAG})
    found = search_model(problem, SHIPPED, USE)
    assert {law.name for law in found.model.laws} == {"linear_drag", "push by place"}
    rest = without(problem, found, next(law for law in found.model.laws if law.name == "linear_drag"))
    assert rest.smooth is not None and rest.law is rest.smooth.law
    assert [law.name for law in rest.model.laws] == ["push by place"] and rest.unlisted is rest.model.laws[0]
