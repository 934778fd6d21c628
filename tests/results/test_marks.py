"""Figures and printed answers in documents are held against outputs."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from results.__main__ import main
from results.check import problems
from results.page import PAGE
from results.raw import read_raws, write_raw
from tests.results.made_up_house import README


def test_the_page_shows_figure_command_seed_commit_date_and_bar(house: Path) -> None:
    raw, text = read_raws(house)["add-3"], (house / PAGE).read_text()
    assert "| two and 3: sum | 5 | at least 4: reached | `add-3.sum` |" in text
    run = next(line for line in text.splitlines() if line.startswith("| add-3 |"))
    for cell in (f"`{' '.join(raw.command)}`", "7", f"`{raw.commit[:9]}`", raw.date[:10]):
        assert f"| {cell} |" in run
    assert "| a text: found | 12 of 1,300 |  | `words.found` |" in text


def test_a_house_in_order_has_no_problems(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    capsys.readouterr()
    assert problems(house) == [] and main(["check"], house) == 0
    assert capsys.readouterr().out == ""


def test_a_wrong_figure_is_reported_with_file_and_line(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "README.md").write_text(README.replace("**5**", "**6**"))
    (house / "docs" / "deep").mkdir()
    (house / "docs" / "deep" / "page.md").write_text("Well\n\nfound 112 of 1,300 <!-- result: words.found -->\n")
    capsys.readouterr()
    assert main(["check"], house) == 1
    assert capsys.readouterr().out.splitlines() == [
        "README.md:3: '6' where add-3.sum is '5'",
        "docs/deep/page.md:3: '112 of 1,300' where words.found is '12 of 1,300'",
    ]


def test_what_no_run_printed_is_reported_with_its_line(house: Path) -> None:
    block = "```console\n$ python # so\n{}\n```\n\n<!-- output: {} -->\n"
    shown = [block.format(*one) for one in (("found 12 of\n  1,300", "words"), ("found 13", "words"), ("5", "add-3"))]
    (house / "docs" / "page.md").write_text("```sh\nls\n```\n\n" + "\n".join(shown))
    page_of = [line for line in problems(house) if line.startswith("docs/page.md")]
    assert page_of == [
        "docs/page.md:15: 'found 13' is not printed there by words",
        "docs/page.md:20: 'add-3' is no run of results/runs.toml with a text as output",
    ]


@pytest.mark.parametrize(
    ("shown", "words"),
    [
        ("found 1", "'found 1' is not printed there by words"),
        ("found 12 … 1,300", "'found 12 … 1,300' is not printed there by words"),
        ("und 12", "'und 12' is not printed there by words"),
        ("$ other 5\nfound 12", "'$ other 5' is not the command of words"),
        ("$ python -c 'x'", "a mark of printed lines needs a run, and lines that it printed"),
    ],
)
def test_what_is_printed_is_compared_word_by_word(house: Path, shown: str, words: str) -> None:
    (house / "docs" / "page.md").write_text(f"```text\n{shown}\n```\n<!-- output: words -->\n")
    (line,) = [line for line in problems(house) if line.startswith("docs/page.md")]
    assert line.endswith(words)


@pytest.mark.parametrize("shown", ["found 12 of 1,300", "found 12\nof", "found […] 1,300", "- x\n\n"])
def test_what_is_printed_may_be_a_part_of_it(house: Path, shown: str) -> None:
    indent = "  " if shown.startswith("-") else ""
    lines = f"{indent}```text\n{indent}found 12\n{indent}```\n" if indent else f"```text\n{shown}\n```\n"
    (house / "docs" / "page.md").write_text(f"{lines}\n<!-- output: words -->\n")
    assert problems(house) == []


def test_a_mark_of_printed_lines_without_a_block_is_reported(house: Path) -> None:
    (house / "docs" / "page.md").write_text("Words.\n\n<!-- output: words -->\n")
    assert problems(house) == ["docs/page.md: 1 of its marks of printed lines follow no block of ``` or ~~~"]


def test_an_output_without_its_figure_hides_no_other_problem(house: Path) -> None:
    write_raw(house, replace(read_raws(house)["add-3"], output={}))
    (house / "docs" / "page.md").write_text("It is 3 mm off.\n")
    assert main(["check"], house) == 1
    found = "\n".join(problems(house))
    assert "raw/add-3.json: figure sum: the output has no '/sum'" in found and "docs/page.md:1: '3 mm'" in found


def test_lines_are_printed_in_order(house: Path) -> None:
    text = "```text\nof 1,300\nfound 12\n```\n<!-- output: words -->\n"
    (house / "docs" / "page.md").write_text(text)
    assert "docs/page.md:3: 'found 12' is not printed there by words" in problems(house)


def test_a_number_with_a_unit_needs_a_mark_or_a_statement(house: Path) -> None:
    text = (
        "`8 mm` is code, found 12 of\n1,300 <!-- result: words.found --> too, but 3 mm, 4 to 5 % and 2 of\n7 are not.\n"
    )
    (house / "docs" / "page.md").write_text(text)
    words = "has no mark; mark it, or state it in results/stated.toml"
    assert [line for line in problems(house) if "page.md" in line] == [
        f"docs/page.md:2: '{number}' {words}" for number in ("3 mm", "4 to 5 %", "2 of 7")
    ]
    stated = (
        'format = "puckpilot-stated/1"\n"docs/page.md" = ["3 mm", "4 to 5 %", "2 of 7", "9 s"]\n"docs/no.md" = []\n'
    )
    (house / "results" / "stated.toml").write_text(stated)
    assert problems(house) == [
        "results/stated.toml: '9 s' is stated of docs/page.md, which has no such number",
        "results/stated.toml: docs/no.md is no document",
    ]


def test_a_table_of_stated_numbers_is_read_strictly(house: Path) -> None:
    (house / "results" / "stated.toml").write_text('format = "puckpilot-stated/1"\n"docs/page.md" = "3 mm"\n')
    with pytest.raises(ValueError, match=r"stated.toml: 'docs/page.md' is no list of texts"):
        problems(house)


def test_a_mark_of_nothing_is_reported(house: Path) -> None:
    (house / "README.md").write_text("1 <!-- result: add-3.product -->\n7 <!-- result: add-5.sum -->\n")
    (house / "results" / "raw" / "add-5.json").unlink()
    assert main(["page"], house) == 0
    assert problems(house) == [
        "README.md:1: results/runs.toml has no figure 'add-3.product'",
        "README.md:2: add-5.sum has no raw output; python -m results run add-5",
    ]
