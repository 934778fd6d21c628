"""The selection of laws on synthetic residuals: none in noise, and the right one where a law generated them."""

import numpy as np
import pytest

from sim2real.diagnose.engine.alternatives import compare, nominal_p
from sim2real.diagnose.engine.forward_selection import ForwardSelection
from sim2real.diagnose.engine.law import Law, Model
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.linear.dispersion import estimated_dispersion
from sim2real.diagnose.engine.problem import DesignMatrix, Units

LAUNCHES, SEGMENTS, EACH = 16, 3, 20  # launches, segments in each, residuals in each segment
NAMES = ("tilt", "drag", "patch", "drift", "slope")
LAWS = [Law(name, (name,)) for name in NAMES]
FAMILY = Law("by place", tuple(f"place {k}" for k in range(6)), "position")
BASE = Model(("base",))
UNITS = Units(np.repeat(np.arange(LAUNCHES), SEGMENTS), np.full(LAUNCHES * SEGMENTS, float(EACH)))
EVERY = np.arange(LAUNCHES)


def _equations(sizes, seed: int = 0, noise: float = 1.0) -> normal_equations.NormalEquations:
    """Return noise plus laws, whose sizes are a number or one for each launch."""
    rng = np.random.default_rng(seed)
    names = ("base", *NAMES, *FAMILY.columns)
    n = LAUNCHES * SEGMENTS * EACH
    jacobian = rng.normal(size=(n, len(names)))
    jacobian[:, 2] = 0.6 * jacobian[:, 1] + 0.8 * jacobian[:, 2]  # drag is correlated with tilt
    r = noise * rng.normal(size=n)
    for name, size in sizes.items():
        r -= np.repeat(np.broadcast_to(size, LAUNCHES), SEGMENTS * EACH) * jacobian[:, names.index(name)]
    return normal_equations.make_equations(
        names, r, jacobian, np.repeat(np.arange(LAUNCHES * SEGMENTS), EACH), LAUNCHES * SEGMENTS
    )


def _chosen(equations: normal_equations.NormalEquations, use: np.ndarray = EVERY) -> list[str]:
    laws = [*LAWS, FAMILY]
    selection = ForwardSelection(equations, UNITS, use, estimated_dispersion(equations, UNITS, BASE.base, laws, use))
    return [law.name for law in selection.eliminate_backward(selection.add_forward(BASE, LAWS, 4)).laws]


@pytest.mark.slow
def test_no_law_is_found_in_noise():
    assert not [seed for seed in range(100) if _chosen(_equations({"base": 0.4}, seed))]


@pytest.mark.slow
@pytest.mark.parametrize("name", NAMES)
def test_only_the_law_that_generated_the_data_is_selected(name):
    assert all(_chosen(_equations({name: 0.5}, seed)) == [name] for seed in range(10))


def test_two_correlated_laws_are_both_selected():
    assert all(set(_chosen(_equations({"tilt": 0.5, "drag": -0.4}, seed))) == {"tilt", "drag"} for seed in range(10))


@pytest.mark.parametrize(
    "sizes, verdict",
    [
        ({5: 1.5}, "inconclusive"),
        ({5: 1.5, 9: 1.4}, "passes"),
        ({5: 1.5, 9: -1.4}, "nothing"),
        ({5: 1.5, 9: 0.3}, "inconclusive"),
    ],
)
def test_a_law_that_one_launch_supports_is_inconclusive_unless_another_agrees(sizes, verdict):
    size = np.zeros(LAUNCHES)  # a patch that one or two launches cross; outliers have no common size
    size[list(sizes)] = list(sizes.values())
    rows = np.repeat(size, SEGMENTS * EACH)
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(len(rows), 2)) * np.stack([np.ones(len(rows)), rows != 0.0], axis=1)
    r = rng.normal(size=len(rows)) - rows * jacobian[:, 1]
    segments = np.repeat(np.arange(LAUNCHES * SEGMENTS), EACH)
    equations = normal_equations.make_equations(("base", "patch"), r, jacobian, segments, LAUNCHES * SEGMENTS)
    selection = ForwardSelection(equations, UNITS, EVERY)
    gain = selection.gain(BASE, LAWS[2])
    assert (selection.passes(gain), selection.inconclusive(gain)) == (verdict == "passes", verdict == "inconclusive")


@pytest.mark.parametrize(
    "size, proved", [(0.0, False), (0.1, False), (0.5, True), (np.where(EVERY == 5, 2.0, 0.0), False)]
)
def test_launches_confirm_a_law_that_predicts_most_of_each_other(size, proved):
    selection = ForwardSelection(_equations({"tilt": size}), UNITS, EVERY)
    assert selection.confirmed(BASE.plus(LAWS[0], np.inf)) == proved


def test_a_law_of_alternating_sign_is_rejected():
    selection = ForwardSelection(_equations({"tilt": np.where(EVERY % 2, 1.0, -0.8)}), UNITS, EVERY)
    assert not selection.same_sign_in_halves(BASE, LAWS[0])
    steady = ForwardSelection(_equations({"tilt": 0.5}), UNITS, EVERY)
    assert steady.same_sign_in_halves(BASE, LAWS[0])


def test_one_outlying_launch_does_not_dominate():
    size = np.full(LAUNCHES, 0.5)
    size[3] = -8.0
    assert _chosen(_equations({"tilt": size})) == ["tilt"]


@pytest.mark.slow
def test_noise_beyond_the_sensor_s_is_not_taken_for_a_law():
    assert not [seed for seed in range(40) if _chosen(_equations({}, seed, noise=3.0))]


def test_coefficients_of_each_launch_are_predicted_by_its_own_units():
    rng = np.random.default_rng(3)
    names = ("base", *(f"spin {k}" for k in range(LAUNCHES)))
    launch = np.repeat(EVERY, SEGMENTS * EACH)
    jacobian = rng.normal(size=(len(launch), 1))
    own = jacobian * (launch[:, None] == EVERY)
    r = rng.normal(size=len(launch)) - 2.0 * rng.normal(size=LAUNCHES)[launch] * jacobian[:, 0]
    base = rng.normal(size=jacobian.shape)
    segments = np.repeat(np.arange(LAUNCHES * SEGMENTS), EACH)
    equations = normal_equations.make_equations(names, r, np.hstack([base, own]), segments, LAUNCHES * SEGMENTS)
    selection = ForwardSelection(equations, UNITS, EVERY)
    assert selection.passes(selection.gain(BASE, Law("spin", names[1:], "history", each_launch=True)))


def test_nominal_p_values_are_conservative():
    seeds, p_values = 150, []
    for seed in range(seeds):
        equations = _equations({}, seed)
        selection = ForwardSelection(equations, UNITS, EVERY)
        columns = DesignMatrix(equations, LAWS, [])
        p_values.append(min(nominal_p(selection, BASE.plus(law, np.inf), law, columns) for law in LAWS))
    assert np.mean(np.array(p_values) < 0.05) <= 0.05 + 2.0 * np.sqrt(0.05 * 0.95 / seeds)
    assert min(p_values) < 0.3  # and not too conservative


def test_identical_columns_are_both_possible():
    equations = _equations({"tilt": 0.5})
    place = {name: k for k, name in enumerate(equations.names)}
    index = np.arange(len(equations.names))
    index[place["patch"]] = place["tilt"]
    g, b = equations.whole()
    same = normal_equations.packed(equations.names, g[:, index][:, :, index], b[:, index], equations.s)
    selection = ForwardSelection(same, UNITS, EVERY)
    model = BASE.plus(LAWS[0], np.inf)
    also, alternatives = compare(selection, model, LAWS[0], DesignMatrix(same, LAWS, []))
    assert also == ("patch",)
    assert {one.mechanism: one.reason for one in alternatives}["patch"].startswith("equivalent: these data")
    shape = Law("shape", ("patch",), "position")
    also, alternatives = compare(selection, model, LAWS[0], DesignMatrix(same, LAWS[:1], [shape]))
    assert also == () and alternatives[0].reason.startswith("equivalent, but nonparametric")
