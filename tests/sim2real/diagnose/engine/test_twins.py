"""Controls of a proof: laws gain on what they made, and nothing on its twins."""

import numpy as np
import pytest

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Chooser, Model
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.twins import NULL, PERMUTED, twins
from sim2real.diagnose.problem import Units

LAUNCHES, EACH = 24, 40
USE, PROOF = np.arange(18), np.arange(18, LAUNCHES)
UNITS = Units(np.arange(LAUNCHES), np.full(LAUNCHES, float(EACH)))
ONE = Model(("base",), (Law("push", ("push",)),), (np.inf,))


def _grams(columns: int = 1, size: float = 1.0):
    """White noise about a baseline, and a law of this size, the first of so many columns."""
    rng = np.random.default_rng(4)
    jacobian = rng.normal(size=(LAUNCHES * EACH, 1 + columns))
    r = -0.7 * jacobian[:, 0] - size * jacobian[:, 1] + rng.normal(size=len(jacobian))
    names = ("base", *(f"push {k}" if k else "push" for k in range(columns)))
    return gram.make_grams(names, r, jacobian, np.repeat(np.arange(LAUNCHES), EACH), LAUNCHES)


def test_a_true_law_gains_nothing_on_noise():
    twin = twins(_grams(), UNITS, ONE, [], USE, PROOF)[NULL]
    assert twin.before == pytest.approx(1.0, abs=0.03)
    assert twin.after == pytest.approx(twin.before, abs=0.01)
    assert (twin.named, twin.of) == (0, 6)


def test_a_true_law_gains_nothing_where_launches_disagree_on_its_sign():
    twin = twins(_grams(), UNITS, ONE, [], USE, PROOF)[PERMUTED]
    assert twin.before == pytest.approx(np.sqrt(2.0), rel=0.1)
    assert twin.after > twin.before - 0.01


def test_too_rich_a_law_is_seen_to_lose_on_noise():
    rich = Model(("base",), (Law("push", tuple(f"push {k}" if k else "push" for k in range(60))),), (np.inf,))
    twin = twins(_grams(60, 0.0), UNITS, rich, [], USE, PROOF)[NULL]
    expected = np.sqrt(1.0 + 60 / (len(USE) * EACH))  # of a fit to white noise: columns over residuals, more error
    assert twin.after / twin.before == pytest.approx(expected, rel=0.02)


def test_a_search_of_twins_finds_what_is_in_them(monkeypatch):
    """Noise that holds a law, which the true noise of twins does not."""
    planted = gram.moved(_grams(), np.array([1]), np.array([0.5]))
    monkeypatch.setattr("sim2real.diagnose.engine.twins._noise", lambda grams, units, rng: planted)
    twin = twins(_grams(), UNITS, ONE, [], USE, PROOF)[NULL]
    assert (twin.named, twin.of) == (6, 6)


def test_the_search_among_twins_is_among_all_laws_of_a_name(monkeypatch):
    """Each size at which a law is looked for."""
    sizes = [Law("push", (f"push {k}" if k else "push",)) for k in range(4)]
    searched, honest = [], Chooser.add

    def noting(self, model, laws, most):
        searched.append(laws)
        return honest(self, model, laws, most)

    monkeypatch.setattr(Chooser, "add", noting)
    twins(_grams(4), UNITS, ONE, sizes, USE, PROOF)
    assert searched and all({law.columns for law in laws} == {law.columns for law in sizes} for laws in searched)
