"""Scores, figures and the confusion matrix, from diagnoses written by hand."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from sim2real.study.confusion import confuse, draw
from sim2real.study.figures import by_mechanism, figures, median, share
from sim2real.study.scoring import Score, score

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
    silent = score("a", truth, answer(verdict="undetermined"))
    assert (silent.named, silent.within, silent.set_size) == (False, False, None)
    two = key("two", "table_tilt", "mallet_give", regimes=("glide", "mallet"))
    assert score("a", two, answer(finding("mallet_give", "mallet"), finding("table_tilt"))).named
    assert not score("a", two, answer(finding("table_tilt"))).named


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
        assert (one.named, one.verdict, one.error) == (False, "failed", "boom")


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
    assert table["truth in winner + also_possible"].value == pytest.approx(2 / 4)
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
