"""Published figures follow from raw outputs: those of this repository, and of a made-up one with faults."""

from __future__ import annotations

import json
import shutil
import subprocess
from dataclasses import replace
from pathlib import Path

import pytest

from results.__main__ import main
from results.check import problems, wrong_marks, wrong_outputs
from results.console import wrong_printed
from results.marks import marks
from results.page import PAGE, page
from results.raw import Raw, read_raws, write_raw
from results.rows import Bar, Figure, Row, read_rows
from results.run import chosen, run_all
from results.unmarked import wrong_numbers
from results.values import figure_text, reaches, value
from tests.places import ROOT

RUNS = """format = "puckpilot-runs/1"

[figures]
sums = [{ name = "sum", what = "sum", values = ["/sum"], show = "{}", bar = { words = "at least 4", least = 4 } }]

[[run]]
id = "add-{each}"
each = ["3", "5"]
topic = "Sums"
title = "two and {each}"
command = ["python", "-c", "print('{\\"sum\\":', 2 + {each}, '}')", "--seed", "7", "--json"]
minutes = 0.1
figures = "sums"

[[run]]
id = "words"
topic = "Words"
title = "a text"
command = ["python", "-c", "import os; print(os.getcwd() + '/x', 'found 12 of 1,300')"]
minutes = 2
seed = 3
figures = [{ name = "found", what = "found", find = 'found (\\d+) of (\\S+)', show = "{} of {:,}" }]
"""
README = """# House

The sum is **5** <!-- result: add-3.sum -->, and

| a | b |
| --- | --- |
| found 12 of
1,300 <!-- result: words.found --> | `7 <!-- result: nothing.at-all -->` |

```
8 <!-- result: add-3.sum -->
```
"""


def test_the_page_follows_from_the_outputs() -> None:
    assert (ROOT / PAGE).read_text(encoding="utf-8") == page(read_rows(ROOT), read_raws(ROOT))


def test_every_marked_figure_agrees() -> None:
    assert wrong_marks(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_printed_answer_was_printed() -> None:
    assert wrong_printed(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_number_with_a_unit_is_marked_or_stated() -> None:
    assert wrong_numbers(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


def test_every_output_is_of_its_row_and_of_a_commit_of_this_history() -> None:
    assert read_raws(ROOT)
    assert wrong_outputs(ROOT, read_rows(ROOT), read_raws(ROOT)) == []


@pytest.fixture(scope="module")
def house_in_order(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository with three runs, their outputs and a README that agrees with them."""
    root = tmp_path_factory.mktemp("results") / "house"
    (root / "results").mkdir(parents=True)
    (root / "results" / "runs.toml").write_text(RUNS)
    (root / "README.md").write_text(README)
    (root / "code.py").write_text("")
    git(root, "init", "-q")
    git(root, "add", ".")
    git(root, "commit", "-qm", "first")
    assert main(["run"], root) == 0 and main(["page"], root) == 0
    return root


@pytest.fixture
def house(house_in_order: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return shutil.copytree(house_in_order, tmp_path / "house")


def git(root: Path, *words: str) -> str:
    who = ("-c", "user.name=a", "-c", "user.email=a@b")
    return subprocess.run(["git", *who, *words], cwd=root, capture_output=True, text=True, check=True).stdout.strip()


def test_a_run_is_kept_with_all_that_it_came_of(house: Path) -> None:
    raw = read_raws(house)["add-3"]
    assert (raw.output, raw.seed, raw.status) == ({"sum": 5}, 7, 0)
    assert raw.commit == git(house, "rev-parse", "HEAD")
    assert {"cpu", "cores", "python", "numpy", "numba"} <= set(raw.machine)
    assert raw.command == next(row.command for row in read_rows(house) if row.id == "add-3")
    text = read_raws(house)["words"]
    assert (text.output, text.seed) == ("x found 12 of 1,300\n", 3)


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


def test_an_output_that_changed_makes_page_and_marks_wrong(house: Path) -> None:
    write_raw(house, replace(read_raws(house)["add-3"], output={"sum": 4}))
    marked, of_page = problems(house)
    assert marked == "README.md:3: '5' where add-3.sum is '4'"
    assert of_page.startswith(f"{PAGE}: ")


def test_outputs_without_row_command_commit_or_figure_are_reported(house: Path) -> None:
    raw = read_raws(house)["add-3"]
    write_raw(house, replace(raw, id="add-4"))
    write_raw(house, replace(raw, commit="0" * 40))
    write_raw(house, replace(raw, id="add-5", command=("python", "-c", "0"), output={"sun": 1}))
    lines = wrong_outputs(house, read_rows(house), read_raws(house))
    assert [line.split(": ")[0] for line in lines] == [f"results/raw/add-{k}.json" for k in (3, 4, 5, 5)]
    assert "its commit 000000000000 is not in this history" in lines[0]
    assert "belongs to no row" in lines[1]
    assert "is of another command, 'python -c 0'" in lines[2]
    assert "figure sum" in lines[3] and "'/sum'" in lines[3]


def test_a_commit_that_was_left_behind_is_unknown(house: Path) -> None:
    git(house, "commit", "-q", "--amend", "-m", "other")
    assert len(wrong_outputs(house, read_rows(house), read_raws(house))) == 3


def test_without_ids_what_is_missing_or_of_another_command_is_run(house: Path) -> None:
    rows = read_rows(house)
    assert chosen(house, rows, [], 10.0) == []
    (house / "results" / "raw" / "words.json").unlink()
    write_raw(house, replace(read_raws(house)["add-3"], command=("python",)))
    assert [row.id for row in chosen(house, rows, [], 10.0)] == ["add-3", "words"]
    assert [row.id for row in chosen(house, rows, [], 1.0)] == ["add-3"]
    assert [row.id for row in chosen(house, rows, ["add-5"], 0.0)] == ["add-5"]
    with pytest.raises(ValueError, match=r"no run 'add-6'; did you mean 'add-"):
        chosen(house, rows, ["add-6"], 1.0)


def row(*words: str, **given: object) -> Row:
    return replace(Row("one", "T", "t", ("python", "-c", *words), 0.1, ()), **given)


def test_a_run_that_fails_keeps_nothing(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    failing = [
        row("raise SystemExit('no such table')"),
        row("print('none')", "--json"),
        row("print('{}'); raise SystemExit(2)", "--json"),
        row("print(1)", needs_shared=True),
        row(command=("puckpilots", "match")),
    ]
    assert run_all(house, failing) == 5 and "one" not in read_raws(house)
    said = capsys.readouterr().out.splitlines()[-5:]
    for line, words in zip(
        said, ("no such table", "printed no JSON but: none", "ended with 2", "../shared", "begins with puckpilot or"),
        strict=True,
    ):  # fmt: skip
        assert words in line


def test_an_answer_of_bad_news_is_an_output(house: Path) -> None:
    assert run_all(house, [row("print('[1]'); raise SystemExit(1)", "--json")]) == 0
    assert (read_raws(house)["one"].output, read_raws(house)["one"].status) == ([1], 1)


def test_code_that_is_not_committed_is_refused(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "README.md").write_text("changed\n")
    assert main(["run", "add-3"], house) == 0
    (house / "code.py").write_text("1\n")
    assert main(["run", "add-3"], house) == 2
    assert "code.py is not committed" in capsys.readouterr().out


def test_code_that_changes_while_it_runs_is_refused(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run_all(house, [row("open('new.py', 'w')")]) == 1 and "one" not in read_raws(house)
    assert "new.py was changed while it ran" in capsys.readouterr().out


def test_a_broken_output_is_one_line(house: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (house / "results" / "raw" / "add-3.json").write_text('{"format": "puckpilot-result/1"')
    assert main(["check"], house) == 2
    assert "add-3.json: is no raw output" in capsys.readouterr().err


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ("minutes = 2", "minutos = 2", "did you mean 'minutes'"),
        ("minutes = 2\n", "", "minutes"),
        ('id = "words"', 'id = "add-3"', "there twice"),
        ('id = "words"', 'id = "a word"', "is no name"),
        ('figures = "sums"', 'figures = "sum"', "did you mean 'sums'"),
        ('figures = "sums"', 'figures = "sums"\nseed = 7', "names its seed twice"),
        ("find = 'found", "values = ['/a'], find = 'found", "expected `find` alone"),
    ],
)
def test_a_faulty_table_of_runs_is_refused_in_one_line(house: Path, old: str, new: str, words: str) -> None:
    (house / "results" / "runs.toml").write_text(RUNS.replace(old, new))
    with pytest.raises(ValueError, match=words):
        read_rows(house)


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
