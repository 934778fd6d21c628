"""The choice of laws, on residuals whose truth is drawn here: silent on noise, right where one law made them."""

import numpy as np
import pytest

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.choose import Chooser, Model
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.noise import dispersion
from sim2real.diagnose.engine.rivals import chance, compare
from sim2real.diagnose.problem import Columns, Units

LAUNCHES, PIECES, EACH = 16, 3, 20  # launches, pieces in each, residuals in each of those
NAMES = ("tilt", "drag", "patch", "drift", "slope")
LAWS = [Law(name, (name,)) for name in NAMES]
FAMILY = Law("by place", tuple(f"place {k}" for k in range(6)), "position")
BASE = Model(("base",))
UNITS = Units(np.repeat(np.arange(LAUNCHES), PIECES), np.full(LAUNCHES * PIECES, float(EACH)))
EVERY = np.arange(LAUNCHES)


def _grams(sizes, seed: int = 0, noise: float = 1.0) -> gram.Grams:
    """Noise about laws whose sizes are numbers, or one for each launch."""
    rng = np.random.default_rng(seed)
    names = ("base", *NAMES, *FAMILY.columns)
    n = LAUNCHES * PIECES * EACH
    jacobian = rng.normal(size=(n, len(names)))
    jacobian[:, 2] = 0.6 * jacobian[:, 1] + 0.8 * jacobian[:, 2]  # drag looks like tilt in part
    r = noise * rng.normal(size=n)
    for name, size in sizes.items():
        r -= np.repeat(np.broadcast_to(size, LAUNCHES), PIECES * EACH) * jacobian[:, names.index(name)]
    return gram.make_grams(names, r, jacobian, np.repeat(np.arange(LAUNCHES * PIECES), EACH), LAUNCHES * PIECES)


def _chosen(grams: gram.Grams, use: np.ndarray = EVERY) -> list[str]:
    laws = [*LAWS, FAMILY]
    chooser = Chooser(grams, UNITS, use, dispersion(grams, UNITS, BASE.base, laws, use))
    return [law.name for law in chooser.prune(chooser.add(BASE, LAWS, 4)).laws]


def test_noise_is_left_alone():
    assert not [seed for seed in range(100) if _chosen(_grams({"base": 0.4}, seed))]


@pytest.mark.parametrize("name", NAMES)
def test_the_law_that_made_the_data_is_chosen_and_no_other(name):
    assert all(_chosen(_grams({name: 0.5}, seed)) == [name] for seed in range(10))


def test_two_laws_are_both_chosen_though_they_look_alike():
    assert all(set(_chosen(_grams({"tilt": 0.5, "drag": -0.4}, seed))) == {"tilt", "drag"} for seed in range(10))


@pytest.mark.parametrize(
    "sizes, told",
    [
        ({5: 1.5}, "doubtful"),
        ({5: 1.5, 9: 1.4}, "sure"),
        ({5: 1.5, 9: -1.4}, "nothing"),
        ({5: 1.5, 9: 0.3}, "doubtful"),
    ],
)
def test_what_a_launch_asks_for_is_doubted_unless_another_says_the_same(sizes, told):
    size = np.zeros(LAUNCHES)  # a patch that one or two launches cross; accidents agree on no size
    size[list(sizes)] = list(sizes.values())
    rows = np.repeat(size, PIECES * EACH)
    rng = np.random.default_rng(1)
    jacobian = rng.normal(size=(len(rows), 2)) * np.stack([np.ones(len(rows)), rows != 0.0], axis=1)
    r = rng.normal(size=len(rows)) - rows * jacobian[:, 1]
    pieces = np.repeat(np.arange(LAUNCHES * PIECES), EACH)
    grams = gram.make_grams(("base", "patch"), r, jacobian, pieces, LAUNCHES * PIECES)
    chooser = Chooser(grams, UNITS, EVERY)
    gain = chooser.gain(BASE, LAWS[2])
    assert (chooser.passes(gain), chooser.doubtful(gain)) == (told == "sure", told == "doubtful")


@pytest.mark.parametrize(
    "size, proved", [(0.0, False), (0.1, False), (0.5, True), (np.where(EVERY == 5, 2.0, 0.0), False)]
)
def test_launches_prove_a_law_that_explains_most_of_each_other(size, proved):
    chooser = Chooser(_grams({"tilt": size}), UNITS, EVERY)
    assert chooser.proved(BASE.plus(LAWS[0], np.inf)) == proved


def test_a_law_of_other_sign_in_every_other_launch_is_refused():
    chooser = Chooser(_grams({"tilt": np.where(EVERY % 2, 1.0, -0.8)}), UNITS, EVERY)
    assert not chooser.same_in_both_halves(BASE, LAWS[0])
    steady = Chooser(_grams({"tilt": 0.5}), UNITS, EVERY)
    assert steady.same_in_both_halves(BASE, LAWS[0])


def test_an_odd_launch_outweighs_no_law():
    size = np.full(LAUNCHES, 0.5)
    size[3] = -8.0
    assert _chosen(_grams({"tilt": size})) == ["tilt"]


def test_more_noise_than_the_sensors_names_nothing():
    assert not [seed for seed in range(40) if _chosen(_grams({}, seed, noise=3.0))]


def test_numbers_of_each_launch_are_foretold_by_its_own_pieces():
    rng = np.random.default_rng(3)
    names = ("base", *(f"spin {k}" for k in range(LAUNCHES)))
    launch = np.repeat(EVERY, PIECES * EACH)
    jacobian = rng.normal(size=(len(launch), 1))
    own = jacobian * (launch[:, None] == EVERY)
    r = rng.normal(size=len(launch)) - 2.0 * rng.normal(size=LAUNCHES)[launch] * jacobian[:, 0]
    base = rng.normal(size=jacobian.shape)
    pieces = np.repeat(np.arange(LAUNCHES * PIECES), EACH)
    grams = gram.make_grams(names, r, np.hstack([base, own]), pieces, LAUNCHES * PIECES)
    chooser = Chooser(grams, UNITS, EVERY)
    assert chooser.passes(chooser.gain(BASE, Law("spin", names[1:], "history", each_launch=True)))


def test_chances_are_no_smaller_than_they_say():
    seeds, told = 150, []
    for seed in range(seeds):
        grams = _grams({}, seed)
        chooser = Chooser(grams, UNITS, EVERY)
        columns = Columns(grams, LAWS, [])
        told.append(min(chance(chooser, BASE.plus(law, np.inf), law, columns) for law in LAWS))
    assert np.mean(np.array(told) < 0.05) <= 0.05 + 2.0 * np.sqrt(0.05 * 0.95 / seeds)
    assert min(told) < 0.3  # and no larger than need be


def test_columns_that_are_one_are_both_possible():
    grams = _grams({"tilt": 0.5})
    place = {name: k for k, name in enumerate(grams.names)}
    same = np.arange(len(grams.names))
    same[place["patch"]] = place["tilt"]
    twin = gram.Grams(grams.names, grams.g[:, same][:, :, same], grams.b[:, same], grams.s, grams.count)
    chooser = Chooser(twin, UNITS, EVERY)
    model = BASE.plus(LAWS[0], np.inf)
    also, rivals = compare(chooser, model, LAWS[0], Columns(twin, LAWS, []))
    assert also == ("patch",)
    assert {rival.mechanism: rival.reason for rival in rivals}["patch"].startswith("as good: this recording cannot")
    shape = Law("shape", ("patch",), "position")
    also, rivals = compare(chooser, model, LAWS[0], Columns(twin, LAWS[:1], [shape]))
    assert also == () and rivals[0].reason.startswith("as good, but of any shape")
