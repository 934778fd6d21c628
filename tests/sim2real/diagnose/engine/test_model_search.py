"""From residuals to a result: findings, none, rejected or undetermined, on synthetic data."""

import numpy as np
import pytest

from sim2real.diagnose.engine.cross_validation import select
from sim2real.diagnose.engine.model_search import search_model
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.regimes.contact.base import ContactRegime
from sim2real.diagnose.result.regime_result import regime_result
from sim2real.diagnose.result.result import Proof, RegimeResult
from tests.sim2real.diagnose.engine.linear_problem import DEFAULTS, LAUNCHES, LinearProblem, LinearRegime

USE, OTHERS = np.arange(LAUNCHES)[::2], np.arange(LAUNCHES)[1::2]
TILT = {"tilt_x": 0.02, "tilt_y": -0.03}


def _said(problem) -> RegimeResult:
    return regime_result(LinearRegime(), problem, select(problem, search_model(problem, DEFAULTS, USE)), DEFAULTS)


def _searched(truth, noise: float = 1.0, smooth: bool = False) -> RegimeResult:
    problem = LinearProblem(truth, noise, smooth=smooth)
    return _said(problem)


def test_default_parameters_agree():
    found = _searched({})
    assert (found.findings, found.defaults, found.undetermined) == ((), True, "")
    assert Diagnosis((found,)).verdict == "agrees"


def test_other_parameters_are_no_finding():
    found = _searched({"friction": 0.2})
    assert (found.findings, found.defaults) == ((), False)
    assert found.baseline["friction"].low < 0.2 < found.baseline["friction"].high
    assert Diagnosis((found,)).verdict == "parameters_only"


def test_a_law_is_found_estimated_and_shown_with_null_controls():
    found = _searched({**TILT, "friction": 0.2})
    (one,) = found.findings
    assert one.mechanism == "table_tilt" and one.p_value < 1e-12
    for name, value in TILT.items():
        assert one.parameters[name].low < value < one.parameters[name].high
        assert one.parameters[name].value == pytest.approx(value, rel=0.1)
    size = 50.0 * np.hypot(TILT["tilt_x"], TILT["tilt_y"])  # rms residual due to it, in units of the noise
    assert found.selection is not None
    assert found.selection.before_m / found.selection.floor_m == pytest.approx(np.hypot(1.0, size), rel=0.1)
    assert found.selection.after_m / found.selection.floor_m == pytest.approx(1.0, abs=0.1)
    assert one.before is one.after is None  # only the holdout sets them
    assert one.null_controls["null"].named == 0 and one.null_controls["null"].after == pytest.approx(1.0, abs=0.1)


def test_a_law_that_held_out_launches_contradict_is_rejected():
    signs = np.where(np.isin(np.arange(LAUNCHES), OTHERS), -1.0, 1.0)
    found = _searched({name: value * signs for name, value in TILT.items()})
    assert found.findings == () and found.misfit
    assert Diagnosis((found,)).verdict == "undetermined"
    assert found.selection is not None and found.selection.after_m == found.selection.before_m
    assert found.doubt == "table_tilt would fit, but cross-validation over launches rejects it"


def test_a_law_that_hardly_improves_the_prediction_is_rejected():
    """If half of the launches have a tilt and the others -0.9 times it, a fit to all explains hardly anything; if the
    others have half of it, a fit to all explains most."""
    for there, expected in ((-0.9, []), (0.5, ["table_tilt"])):
        share = np.where(np.isin(np.arange(LAUNCHES), OTHERS), there, 1.0)
        found = _searched({name: 4.0 * value * share for name, value in TILT.items()})
        assert [one.mechanism for one in found.findings] == expected and found.misfit is not bool(expected)


@pytest.mark.parametrize("against, expected", [(0, True), (1, True), (10, False)])
def test_a_smooth_term_may_fail_in_one_launch_but_not_in_half_of_them(against, expected):
    """`against` of twenty launches have the opposite effect, far beyond the noise."""
    signs = np.ones(LAUNCHES)
    signs[OTHERS[:against]] = -1.0
    problem = LinearProblem({name: value * signs for name, value in TILT.items()}, smooth=True)
    found = regime_result(
        LinearRegime(), problem, select(problem, search_model(problem, DEFAULTS, np.arange(LAUNCHES))), DEFAULTS
    )
    assert [one.mechanism for one in found.findings] == (["unlisted"] if expected else [])
    assert found.misfit is not expected


def test_a_needless_smooth_term_is_not_reported():
    found = _searched({}, smooth=True)
    assert (found.findings, found.defaults, found.undetermined) == ((), True, "")


def test_launches_without_sensitivity_do_not_reject_a_law():
    """Launches without an effect of the tilt: only their noise decides which model is slightly better."""
    verdicts = []
    for seed in range(4):
        problem = LinearProblem(TILT, seed=seed)
        problem.remove_sensitivity(OTHERS, ("tilt_x", "tilt_y"))
        found = _said(problem)
        verdicts.append([one.mechanism for one in found.findings])
    assert verdicts == 4 * [["table_tilt"]]


@pytest.mark.parametrize(
    "after, expected", [(1.0, []), (2.9, []), (30.0, ["wall: the remaining residual is 30 mm, 30 times the noise"])]
)
def test_large_remaining_residuals_are_reported(after, expected):
    wall = RegimeResult(
        "wall", (), {}, False, Proof(0.05, 1e-3 * after, 1e-3, 9), proof=Proof(0.05, 1e-3 * after, 1e-3, 9)
    )
    remarks = Diagnosis((wall,)).remarks
    assert remarks == expected


def test_an_unexplained_misfit_is_no_agreement():
    found = _searched({}, noise=2.5)
    assert found.findings == () and found.misfit and not found.defaults
    diagnosis = Diagnosis((found,))
    assert diagnosis.verdict == "undetermined"
    assert any("an effect is missing" in remark for remark in diagnosis.remarks)


class ResidualsAsSizes(LinearRegime):
    """Residuals say how large what is missing is, as those of contacts do."""

    misfit_size = ContactRegime.misfit_size


@pytest.mark.parametrize(("noise_m", "left"), [(1e-4, "0.23"), (1e-3, "")])
def test_a_misfit_smaller_than_any_effect_that_is_reported_is_none(noise_m, left):
    """The residuals are 2.5 times the noise: sqrt(2.5^2 - 1) = 2.29 of them are unexplained."""
    problem = LinearProblem({}, 2.5)
    problem.noise_m = noise_m
    chosen = select(problem, search_model(problem, DEFAULTS, USE))
    found = regime_result(ResidualsAsSizes(), problem, chosen, DEFAULTS)
    assert found.misfit is not bool(left) and found.defaults is bool(left)
    said = f"what no law explains is only {left} mm; effects below 0.5 mm are not reported"
    assert found.minor == (said if left else "")
    assert Diagnosis((found,)).verdict == ("agrees" if left else "undetermined")
    assert regime_result(LinearRegime(), problem, chosen, DEFAULTS).misfit  # where a refitted start may hide more


def test_a_regime_with_too_little_data_is_reported_and_does_not_affect_the_verdict():
    wall = RegimeResult("wall", (), {}, False, None, "too little data", "record more bounces")
    diagnosis = Diagnosis((_searched({}), wall))
    assert diagnosis.verdict == "agrees"
    assert diagnosis.remarks == ["wall: undetermined, too little data"]
    assert diagnosis.next_recording == "record more bounces"
