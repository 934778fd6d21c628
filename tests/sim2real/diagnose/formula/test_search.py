"""A readable formula from data of a known law: its form, its parameters, its text."""

import numpy as np
import pytest

from sim2real.diagnose.formula.search import FormulaProblem, find_formula
from sim2real.diagnose.formula.shapes import Axis, Direction, form, harmonic, profiles
from sim2real.diagnose.regimes.sliding.forces import central_forces
from sim2real.diagnose.regimes.sliding.forces.motion import Motion

NOISE = 0.01
CLUSTERS = 20
POINTS = 1200


def _rest(seen: np.ndarray, base: np.ndarray | None = None, seed: int = 0) -> FormulaProblem:
    """Return data (n, c) with noise, measured directly; `base` (n, b) is fitted jointly."""
    rng = np.random.default_rng(seed)
    flat = (seen + rng.normal(0.0, NOISE, seen.shape)).reshape(-1) / NOISE
    cluster = np.repeat(np.arange(len(seen)) * CLUSTERS // len(seen), seen.shape[1])
    columns = np.zeros((len(flat), 0)) if base is None else base
    every = np.arange(CLUSTERS)
    return FormulaProblem(flat, columns, cluster, every, len(flat), lambda laws: laws.reshape(len(flat), -1) / NOISE)


def _formula(u: np.ndarray, law: np.ndarray, made, offset: bool = False):
    axis = Axis("u", "s", u, offset)
    side = Direction("a", "", "along it", np.ones((len(u), 1)))
    forms = [form(one, axis, [side], "m/s^2") for one in made(axis)]
    return find_formula(_rest(law[:, None]), forms, lambda one, shape: ())


def _profiles(axis):
    return profiles(axis, "m/s^2")


@pytest.mark.parametrize(
    "law, name, numbers",
    [
        (lambda u: 0.3 * u, "linear", {"slope": 0.3}),
        (lambda u: -0.08 * u**3, "cubic", {"slope": -0.08}),
        (lambda u: 0.2 * np.exp(-u / 0.21), "decay", {"size": 0.2, "decay": 0.21}),
        (lambda u: 0.1 * np.sin(2 * np.pi * (u - 0.1) / 0.43), "sine", {"size": 0.1, "wave": 0.43, "shift": 0.1}),
        (lambda u: 0.2 * np.exp(-0.5 * ((u - 1.3) / 0.15) ** 2), "bump", {"size": 0.2, "middle": 1.3, "width": 0.15}),
        (lambda u: 0.15 * (np.abs(u - 0.9) < 0.2), "stripe", {"size": 0.15, "middle": 0.9, "width": 0.4}),
    ],
)
def test_a_law_of_one_coordinate_is_found(law, name, numbers):
    u = np.random.default_rng(1).uniform(0.0, 2.5, POINTS)
    found = _formula(u, law(u), _profiles)
    assert found.form.name.split()[0] == name
    for key, value in numbers.items():
        one = found.parameters[key]
        assert one.value == pytest.approx(value, rel=0.05)
        assert one.low - 0.01 * abs(value) < value < one.high + 0.01 * abs(value)
        assert f"{abs(one.value):.4g}" in found.words or key == "width"  # a stripe's formula has half its width


@pytest.mark.parametrize(
    "law, name",
    [
        (lambda u: 0.3 * u - 0.015 * u**2, "linear"),  # a curvature too small for three parameters
        (lambda u: 0.2 * np.exp(-0.5 * ((u - 2.0) / 0.6) ** 2), "bump"),  # a line would explain three quarters
    ],
)
def test_the_simplest_form_that_explains_nearly_all_is_selected(law, name):
    u = np.random.default_rng(7).uniform(0.0, 2.5, POINTS)
    assert _formula(u, law(u), _profiles).form.name.split()[0] == name


def test_the_words_are_a_formula():
    u = np.linspace(0.0, 2.0, POINTS)
    found = _formula(u, -0.12 * np.exp(-u / 0.21), _profiles)
    p = found.values
    assert found.words == f"a = {p['size']:.4g} exp(-u / {p['decay']:.4g} s) m/s^2 along it"


def test_an_offset_is_fitted_where_the_coordinate_has_one():
    u = np.random.default_rng(2).uniform(0.0, 100.0, POINTS)
    found = _formula(u, 0.05 + 0.002 * u, _profiles, offset=True)
    assert found.values["slope"] == pytest.approx(0.002, rel=0.05)
    assert found.values["offset"] == pytest.approx(0.05, abs=0.005)
    assert found.words == f"a = ({found.values['offset']:.4g} + {found.values['slope']:.4g} u) m/s^2 along it"


def test_an_angle_gets_harmonics():
    heading = np.random.default_rng(3).uniform(-180.0, 180.0, POINTS)
    law = 0.05 * np.cos(2 * np.radians(heading - 30.0))
    found = _formula(heading, law, lambda axis: [harmonic(k, "m/s^2") for k in (1, 2, 3, 4)])
    assert found.values == pytest.approx({"size": 0.05, "toward": 30.0}, rel=0.1)
    assert "cos(2 (u - " in found.words


def test_what_the_baseline_explains_is_not_explained_again():
    """A slope that a baseline parameter fits is removed; the formula is the sine added to it."""
    u = np.random.default_rng(4).uniform(0.0, 2.5, POINTS)
    law = 5.0 * u + 0.1 * np.sin(2 * np.pi * u / 0.5)
    axis, side = Axis("u", "m", u), Direction("a", "", "", np.ones((POINTS, 1)))
    forms = [form(one, axis, [side], "1") for one in profiles(axis, "1")]
    found = find_formula(_rest(law[:, None], base=u[:, None]), forms, lambda one, shape: ())
    assert found.form.name.startswith("sine")
    assert found.values["size"] == pytest.approx(0.1, rel=0.05)


@pytest.mark.parametrize("turn, name", [(True, "local round"), (False, "local away from")])
def test_a_whirl_and_a_source_have_a_middle(turn, name):
    rng = np.random.default_rng(5)
    place = rng.uniform((0.0, 0.0), (2.0, 1.0), (POINTS, 2))
    t, one = np.arange(POINTS) / 100.0, np.zeros(POINTS)
    motion = Motion(
        t, place, np.ones((POINTS, 2)), np.full(POINTS, np.nan), one, t, np.array([2.0, 1.0]), np.array([0.1, 2.0])
    )
    dx, dy = (place - (0.7, 0.6)).T / 0.25
    strength = 0.06 * np.exp(0.5 - 0.5 * (dx**2 + dy**2))
    law = np.stack([-strength * dy, strength * dx] if turn else [strength * dx, strength * dy], axis=1)
    found = find_formula(_rest(law), central_forces.pushes(motion), lambda one, shape: ())
    assert found.form.name == name
    assert found.values == pytest.approx({"size": 0.06, "x": 0.7, "y": 0.6, "radius": 0.25}, rel=0.07)


def test_the_intervals_have_their_nominal_coverage():
    u = np.random.default_rng(6).uniform(0.0, 2.0, 300)
    law = 0.1 * np.exp(-u / 0.5)
    axis, side = Axis("u", "s", u), Direction("a", "", "", np.ones((len(u), 1)))
    forms = [form(one, axis, [side], "1") for one in profiles(axis, "1") if one.name == "decay"]
    held = 0
    for seed in range(60):
        one = find_formula(_rest(law[:, None], seed=seed), forms, lambda one, shape: ()).parameters["decay"]
        held += one.low < 0.5 < one.high
    assert held >= 52  # of 60 at 95 %; fewer has a probability of 1 in 1000
