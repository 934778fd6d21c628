"""Figures are values of outputs, shown as text and judged by bars."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import pytest

from results.marks import marks
from results.raw import Raw, read_raws, write_raw
from results.rows import Bar, Figure
from results.values import figure_text, reaches, value

OUTPUT = {"wins": [3, 1], "a b": {"c/d": 0.25}, "laws": [{"name": "tilt", "x": 2}, {"name": "warp", "x": 0}]}


@pytest.mark.parametrize(
    ("expression", "expected"),
    [
        ("/wins/1", 1),
        ("/wins/length", 2),
        ("/a b/c~1d", 0.25),
        ("/a b/c~1d * 1000", 250.0),
        ("/wins/0 * /a b/c~1d", 0.75),
        ("/wins/0 / /wins/1 / 2", 1.5),
        ("/laws/name=tilt/x", 2),
    ],
)
def test_values(expression: str, expected: float) -> None:
    assert value(expression, OUTPUT) == expected


def test_values_below_a_pointer() -> None:
    assert value("x * 3", OUTPUT, "/laws/name=tilt") == 6


@pytest.mark.parametrize("expression", ["/wins/2", "/laws/name=drag/x", "/none", "/laws * 2", "/wins/0 / /laws/1/x"])
def test_a_value_that_is_not_there(expression: str) -> None:
    with pytest.raises(ValueError, match=r"leads nowhere|asks for"):
        value(expression, OUTPUT)


def test_a_bar_is_judged_by_the_value_that_it_names() -> None:
    figure = Figure("f", "w", "{:.0f} of {}", ("/wins/0", "/wins/1"), bar=Bar("at most 2", of="/wins/1", most=2))
    assert figure_text(figure, OUTPUT) == "3 of 1" and reaches(figure, OUTPUT)
    assert not reaches(replace(figure, bar=Bar("at most 2", most=2)), OUTPUT)
    found = Figure("f", "w", "{:,} {}", find=r"got (\S+) (\w+)", bar=Bar("at least 2,000", least=2000))
    assert figure_text(found, "got 1,999 mm") == "1,999 mm" and not reaches(found, "got 1,999 mm")
    assert reaches(found, "got 2,000.5 mm")
    with pytest.raises(ValueError, match="a bar needs a number"):
        reaches(found, "got some mm")


def test_a_text_without_the_figure() -> None:
    figure = Figure("f", "w", "{:.1f} s", find=r"in (\S+) s")
    assert figure_text(figure, "done in 2.04 s") == "2.0 s"
    with pytest.raises(ValueError, match="has nothing like"):
        figure_text(figure, "done")
    with pytest.raises(ValueError, match="cannot show"):
        figure_text(figure, "done in no s")


@pytest.mark.parametrize(
    ("text", "expected", "agrees"),
    [
        ("won 98 %", "98 %", True),
        ("won **98 %**", "98 %", True),
        ("won 98\n% ", "98 %", True),
        ("| `98 %`", "98 %", True),
        ("mu=0.12", "0.12", True),
        ("won 198 %", "98 %", False),
        ("−0.04", "0.04", False),
        ("1,234", "234", False),
        ("98 % (7)", "98 %", False),
        ("", "98 %", False),
    ],
)
def test_what_stands_before_a_mark(text: str, expected: str, agrees: bool) -> None:
    (mark,) = marks(f"{text} <!-- result: a.b -->")
    assert mark.name == "a.b" and mark.agrees(expected) is agrees


def test_marks_in_code_are_none() -> None:
    text = "`1 <!-- result: a.b -->`\n```\n2 <!-- result: a.b -->\n```\n`3` <!--result:a.c-->\n"
    assert [(mark.name, mark.line) for mark in marks(text)] == [("a.c", 5)]


def test_an_output_is_read_as_it_was_written(tmp_path: Path) -> None:
    raw = Raw("a", ("puckpilot",), None, "c", "2026-01-02T03:04:05+00:00", 1.5, 0, {"cpu": "x"}, {"m": "µ"})
    path = write_raw(tmp_path, raw)
    assert read_raws(tmp_path) == {"a": raw}
    assert "µ" in path.read_text(encoding="utf-8") and [one.name for one in path.parent.iterdir()] == ["a.json"]
    path.rename(path.with_name("b.json"))
    with pytest.raises(ValueError, match=r"is the output of 'a'; expected it in a\.json"):
        read_raws(tmp_path)
    assert json.loads(path.with_name("b.json").read_text(encoding="utf-8"))["format"] == "puckpilot-result/1"
