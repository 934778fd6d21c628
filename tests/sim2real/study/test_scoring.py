"""Scores, figures and the confusion matrix, from diagnoses written by hand."""

from __future__ import annotations

import json
from dataclasses import replace
from math import sqrt
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law as Named
from sim2real.diagnose.engine.least_squares import LeastSquaresFit
from sim2real.diagnose.result.labels import labelled
from sim2real.study.confusion import confuse, draw
from sim2real.study.figures import by_mechanism, figures, median, share
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.mechanisms import MECHANISMS
from sim2real.study.independent_table.physics.puck import acceleration
from sim2real.study.scoring import OTHER_NAMES, Score, score

TILT = {"tilt_x": 0.03, "tilt_y": -0.04}


def key(kind: str, *mechanisms: str, regimes: tuple[str, ...] = ("glide",), **more: Any) -> dict[str, Any]:
    return {
        "kind": kind, "scenario": "launches", "mechanisms": list(mechanisms), "law": None, "depends": None,
        "regimes": list(regimes) if mechanisms else [], "values": {"table_tilt": TILT}, **more,
    }  # fmt: skip


def finding(mechanism: str, regime: str = "glide", **more: Any) -> dict[str, Any]:
    return {"regime": regime, "mechanism": mechanism, "parameters": {}, **more}


def answer(*findings: dict[str, Any], verdict: str = "missing_physics", **more: Any) -> dict[str, Any]:
    return {"seconds": 2.0, "error": None, "diagnosis": {"verdict": verdict, "findings": list(findings), **more}}


def number(value: float, half: float) -> dict[str, Any]:
    return {"value": value, "low": value - half, "high": value + half, "unit": "m/s^2"}


def test_what_is_named_right_and_how_far_its_numbers_are_off():
    parameters = {"tilt_x": number(0.031, 0.002), "tilt_y": number(-0.042, 0.001), "strange": number(1.0, 1.0)}
    heldout = {"before_m": 0.002, "after_m": 0.0007, "floor_m": 0.0005, "pieces": 9}
    found = finding("table_tilt", parameters=parameters, also_possible=["table_warp"])
    one = score("case_0001", key("one", "table_tilt"), answer(found, heldout=heldout))
    assert (one.named, one.located, one.within, one.set_size, one.false_alarm) == (True, True, True, 2.0, None)
    assert one.excess_removed == pytest.approx(1.3 / 1.5)
    x, y = one.numbers
    assert (x.name, x.truth, x.covered, y.covered) == ("tilt_x", 0.03, True, False)
    assert (x.error, y.error) == (pytest.approx(0.001 / 0.05), pytest.approx(0.002 / 0.05))  # of the vector's length


def test_a_number_is_known_by_its_other_name_too():
    truth = key("one", "speed_dependent_restitution", regimes=("wall",))
    truth["values"] = {"speed_dependent_restitution": {"slope": 0.05, "e0": 0.7}}
    found = finding("speed_dependent_restitution", "wall", parameters={"e_slope": number(0.04, 0.02)})
    (slope,) = score("a", truth, answer(found)).numbers
    assert (slope.name, slope.error, slope.covered) == ("slope", pytest.approx(0.2), True)


def test_wrong_names_wrong_places_and_one_name_too_many():
    truth = key("one", "table_tilt")
    wrong = score("a", truth, answer(finding("side_force", also_possible=["table_tilt"])))
    assert (wrong.named, wrong.located, wrong.within, wrong.set_size) == (False, True, True, 2.0)
    assert wrong.numbers == ()
    elsewhere = score("a", truth, answer(finding("voltage_sag", "gantry")))
    assert (elsewhere.named, elsewhere.located, elsewhere.within) == (False, False, False)
    more = score("a", truth, answer(finding("table_tilt"), finding("wall_friction_spin", "wall")))
    assert (more.named, more.located, more.within) == (False, False, True)
    scored = score("a", truth, answer(verdict="undetermined"))
    assert (scored.named, scored.within, scored.set_size) == (False, False, None)
    two = key("two", "table_tilt", "mallet_give", regimes=("glide", "mallet"))
    assert score("a", two, answer(finding("mallet_give", "mallet"), finding("table_tilt"))).named
    assert not score("a", two, answer(finding("table_tilt"))).named


def test_a_number_of_another_wall_is_held_against_nothing_there():
    truth = key("one", "wall_to_wall_restitution", regimes=("wall",))
    truth |= {"values": {"wall_to_wall_restitution": {"delta": 0.05}}}
    truth |= {"where": {"wall_to_wall_restitution": {"walls": ["y0"]}}}
    for walls, error, covered in ((["y0"], 0.2, True), (["x1"], 1.2, False)):
        found = finding(
            "wall_to_wall_restitution", "wall", parameters={"delta": number(0.06, 0.02)}, where={"walls": walls}
        )
        (delta,) = score("a", truth, answer(found)).numbers
        assert (delta.error, delta.covered) == (pytest.approx(error), covered)


def test_the_excess_counts_whatever_was_said_of_it():
    heldout = {"before_m": 0.002, "after_m": 0.002, "floor_m": 0.0005, "pieces": 9}
    no_finding = answer(verdict="parameters_only", heldout=heldout)
    assert score("a", key("one", "table_tilt"), no_finding).excess_removed == 0.0
    wrong = answer(finding("side_force"), heldout={**heldout, "after_m": 0.00125})
    assert score("a", key("one", "table_tilt"), wrong).excess_removed == pytest.approx(0.5)
    assert score("a", key("one", "table_tilt"), answer(verdict="undetermined")).excess_removed is None


@pytest.mark.parametrize("name", sorted(set(MECHANISMS) & set(EFFECTS)))
def test_what_a_diagnosis_calls_its_numbers_the_key_does_too(name: str):
    rng = np.random.default_rng(1)
    draws = [MECHANISMS[name].draw(rng, 1.0, Law(), MECHANISMS[name].scenarios[0]) for _ in range(40)]
    known = {label for change in draws for label in change.values}
    rows = [row.name for row in EFFECTS[name].rows.values()]
    free = ("wall_restitution", "mallet_restitution", *rows)
    fitted = LeastSquaresFit(dict.fromkeys(free, 0.5), free, 1e-8 * np.eye(len(free)), 0.0, 100, ())
    labels = {OTHER_NAMES.get(label, label) for label in labelled(Named(name, tuple(rows[:1])), fitted)}
    assert labels & known and labels - known <= {"spin_coefficient"}  # of a spin that no camera sees


def test_the_ratio_of_an_uneven_friction_is_what_a_puck_feels_along_x_over_along_y():
    for seed in range(6):
        change = MECHANISMS["friction_anisotropy"].draw(np.random.default_rng(seed), 1.0, Law(), "launches")
        law = replace(Law(drag=0.0), **change.law).numbers()
        x, y = (acceleration(law, 0.0, 1.0, 0.5, *v, 0.0, 1.0)[axis] for axis, v in enumerate(((1.0, 0.0), (0.0, 1.0))))
        slant = np.array(acceleration(law, 0.0, 1.0, 0.5, sqrt(0.5), sqrt(0.5), 0.0, 1.0))
        values = change.values
        assert values["ratio"] == pytest.approx(x / y)
        assert values["grain"] == pytest.approx((x - y) / (x + y))
        assert values["turning"] == pytest.approx(2.0 * slant @ (-sqrt(0.5), sqrt(0.5)) / -(x + y), abs=1e-12)


def test_silence_where_nothing_is_missing():
    for kind in ("nothing", "parameters"):
        assert score("a", key(kind), answer(verdict="agrees")).named
        assert score("a", key(kind), answer(verdict="agrees")).false_alarm is False
        assert score("a", key(kind), answer(finding("air_drift"))).false_alarm is True
        unsure = score("a", key(kind), answer(verdict="undetermined"))
        assert (unsure.named, unsure.false_alarm) == (False, False)


def test_an_unlisted_law_and_what_it_depends_on():
    truth = key("unlisted", "unlisted", law="grain", depends=["heading"], values={})
    for depends, right in ((["heading"], True), (["speed"], False), (["heading", "speed"], False)):
        found = score("a", truth, answer(finding("unlisted", depends_on=depends)))
        assert (found.named, found.depends_right) == (True, right)
    assert score("a", truth, answer(finding("friction_anisotropy"))).depends_right is False


def test_no_diagnosis_is_never_right():
    failed = {"seconds": 1.0, "error": "boom", "diagnosis": None}
    for kind, names in (("nothing", ()), ("one", ("table_tilt",))):
        one = score("a", key(kind, *names), failed)
        assert (one.named, one.verdict, one.error, one.false_alarm) == (False, "failed", "boom", None)


def test_shares_and_medians_have_the_intervals_of_the_books():
    some = share("x", [True] * 9 + [False] + [None] * 5, least=0.85)
    assert (some.value, some.count, some.reached) == (0.9, 10, True)
    assert (some.low, some.high) == (pytest.approx(0.55498, abs=1e-5), pytest.approx(0.99747, abs=1e-5))  # tables
    nobody = share("x", [], least=0.5)
    assert (nobody.value, nobody.reached) == (None, None)
    values = np.random.default_rng(1).normal(3.0, 1.0, 400)
    middle = median("m", values, most=2.9)
    assert middle.value == np.median(values) and not middle.reached
    assert middle.high - middle.low == pytest.approx(2 * 1.96 * 1.2533 / 20.0, rel=0.3)  # normal theory
    ranks = median("m", range(1, 21))
    assert (ranks.low, ranks.high) == (6.0, 15.0)  # tables
    few = median("m", [1.0] * 5, most=1.5)  # of five, all are on one side once in 16 times
    assert (few.reached, few.sure) == (True, False)
    assert (few.as_dict()["low"], few.as_dict()["least"]) == (None, None)  # JSON has no infinity


def test_a_bar_is_surely_reached_or_missed_where_the_whole_interval_says_so():
    """Clopper and Pearson: 0 of 24 is up to 0.142, 0 of 400 up to 0.009; 20 of 24 is 0.626 to 0.953."""
    few, many = (share("x", [False] * n, most=0.01) for n in (24, 400))
    assert (few.reached, few.sure, many.reached, many.sure) == (True, False, True, True)
    some = [True] * 20 + [False] * 4
    sure = {least: (share("x", some, least).reached, share("x", some, least).sure) for least in (0.6, 0.8, 0.9, 0.96)}
    assert sure == {0.6: (True, True), 0.8: (True, False), 0.9: (False, False), 0.96: (False, True)}
    assert share("x", [], 0.5).sure is None


def test_a_few_cases_reach_and_miss_nothing():
    four, five = (share("x", [False] * n, least=0.9) for n in (4, 5))
    assert (four.reached, four.sure, four.too_few) == (None, None, True)
    assert (five.reached, five.too_few) == (False, False)
    assert not share("x", [], 0.5).too_few


def test_a_share_is_plain_data_whatever_numbers_the_interval_comes_as(monkeypatch: pytest.MonkeyPatch) -> None:
    import scipy.stats

    class Numpy:
        def proportion_ci(self, level: float, method: str) -> Numpy:
            self.low, self.high = np.float64(0.1), np.float64(0.6)
            return self

    monkeypatch.setattr(scipy.stats, "binomtest", lambda hits, count: Numpy())
    json.dumps(share("x", [True] * 3 + [False] * 7, least=0.85).as_dict())


def made() -> list[Score]:
    right = answer(finding("table_tilt"))
    return [
        score("1", key("nothing"), answer(verdict="agrees")),
        score("2", key("nothing"), right),
        score("3", key("parameters"), answer(verdict="parameters_only")),
        score("4", key("one", "table_tilt"), right),
        score("5", key("one", "table_tilt"), answer(finding("side_force"))),
        score("6", key("one", "table_tilt"), answer(finding("side_force"), finding("table_tilt"))),
        score("7", key("two", "table_tilt", "mallet_give"), right),
    ]


def test_the_table_counts_each_question_where_it_arises():
    table = {figure.name: figure for figure in figures(made(), 60.0)}
    assert (table["named right, one effect"].value, table["named right, one effect"].count) == (1 / 3, 3)
    assert table["named right, one effect"].least == 0.97
    assert {f.name: f for f in figures(made(), 30.0)}["named right, one effect"].least == 0.93
    assert table["false alarms where nothing is missing"].value == pytest.approx(1 / 3)
    assert (table["both of two effects named"].value, table["both of two effects named"].count) == (0.0, 1)
    assert table["truth in findings + also_possible"].value == pytest.approx(2 / 4)
    (tilt,) = by_mechanism(made())
    assert (tilt.name, tilt.value, tilt.count) == ("table_tilt", 1 / 3, 3)


def test_the_matrix_says_who_was_taken_for_whom(tmp_path: Path):
    matrix = confuse(made())
    assert matrix.columns == ("agrees", "parameters_only", "side_force", "table_tilt", "several")
    assert matrix.rows == ("agrees", "parameters_only", "table_tilt")
    assert matrix.counts == ((1, 0, 0, 1, 0), (0, 1, 0, 0, 0), (0, 0, 1, 1, 1))
    draw(tmp_path / "m.png", matrix)
    with Image.open(tmp_path / "m.png") as picture:
        red, green, _ = np.asarray(picture.convert("RGB"), dtype=int).reshape(-1, 3).T
    assert ((red < 130) & (green > 200)).any() and ((red > 200) & (green < 200)).any()


def test_where_all_cases_have_two_effects_the_picture_says_so(tmp_path: Path):
    said = answer(finding("table_tilt"), finding("linear_drag"))
    matrix = confuse([score("case_0000", key("two", "table_tilt", "linear_drag"), said)])
    assert matrix.rows == ()
    draw(tmp_path / "m.png", matrix)
    assert np.asarray(Image.open(tmp_path / "m.png").convert("L")).min() < 100
