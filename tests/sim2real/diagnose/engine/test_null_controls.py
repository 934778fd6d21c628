"""Null controls: laws improve the prediction of data that they generated, and not of null data."""

import numpy as np
import pytest

from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.null_controls import NULL, PERMUTED, null_controls
from sim2real.diagnose.engine.problem import Units

LAUNCHES, EACH = 24, 40
USE, TEST = np.arange(18), np.arange(18, LAUNCHES)
UNITS = Units(np.arange(LAUNCHES), np.full(LAUNCHES, float(EACH)))
ONE = Model(("base",), (Law("push", ("push",)),), (np.inf,))


def _equations(columns: int = 1, size: float = 1.0):
    """Return white noise, a baseline, and a law of this size in the first of `columns` columns."""
    rng = np.random.default_rng(4)
    jacobian = rng.normal(size=(LAUNCHES * EACH, 1 + columns))
    r = -0.7 * jacobian[:, 0] - size * jacobian[:, 1] + rng.normal(size=len(jacobian))
    names = ("base", *(f"push {k}" if k else "push" for k in range(columns)))
    return normal_equations.make_equations(names, r, jacobian, np.repeat(np.arange(LAUNCHES), EACH), LAUNCHES)


def test_a_true_law_gains_nothing_on_noise():
    control = null_controls(_equations(), UNITS, ONE, [], USE, TEST)[NULL]
    assert control.before == pytest.approx(1.0, abs=0.03)
    assert control.after == pytest.approx(control.before, abs=0.01)
    assert (control.named, control.of) == (0, 6)


def test_a_true_law_gains_nothing_where_launches_disagree_on_its_sign():
    control = null_controls(_equations(), UNITS, ONE, [], USE, TEST)[PERMUTED]
    assert control.before == pytest.approx(np.sqrt(2.0), rel=0.1)
    assert control.after > control.before - 0.01


def test_a_law_of_many_columns_worsens_the_prediction_of_noise():
    rich = Model(("base",), (Law("push", tuple(f"push {k}" if k else "push" for k in range(60))),), (np.inf,))
    control = null_controls(_equations(60, 0.0), UNITS, rich, [], USE, TEST)[NULL]
    expected = np.sqrt(
        1.0 + 60 / (len(USE) * EACH)
    )  # of a fit to white noise: 1 + columns / residuals in the mean square
    assert control.after / control.before == pytest.approx(expected, rel=0.02)


def test_a_search_of_null_data_finds_what_is_in_them(monkeypatch):
    """Noise with a law added, which true noise does not contain."""
    planted = normal_equations.moved(_equations(), np.array([1]), np.array([0.5]))
    monkeypatch.setattr("sim2real.diagnose.engine.null_controls._noise", lambda equations, units, rng: planted)
    control = null_controls(_equations(), UNITS, ONE, [], USE, TEST)[NULL]
    assert (control.named, control.of) == (6, 6)


def test_the_search_of_null_data_includes_all_variants_of_a_law(monkeypatch):
    """Each size at which a law is searched for."""
    sizes = [Law("push", (f"push {k}" if k else "push",)) for k in range(4)]
    searched, original = [], ForwardSelection.add_forward

    def noting(self, model, laws, most):
        searched.append(laws)
        return original(self, model, laws, most)

    monkeypatch.setattr(ForwardSelection, "add_forward", noting)
    null_controls(_equations(4), UNITS, ONE, sizes, USE, TEST)
    assert searched and all({law.columns for law in laws} == {law.columns for law in sizes} for laws in searched)
