"""Runs are made and kept with all that they came of; what cannot be kept is refused."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from results.__main__ import main
from results.check import problems, wrong_outputs
from results.page import PAGE
from results.raw import read_raws, write_raw
from results.rows import Row, read_rows
from results.run import chosen, run_all
from tests.results.made_up_house import RUNS, git


def test_a_run_is_kept_with_all_that_it_came_of(house: Path) -> None:
    raw = read_raws(house)["add-3"]
    assert (raw.output, raw.seed, raw.status) == ({"sum": 5}, 7, 0)
    assert raw.commit == git(house, "rev-parse", "HEAD")
    assert {"cpu", "cores", "python", "numpy", "numba"} <= set(raw.machine)
    assert raw.command == next(row.command for row in read_rows(house) if row.id == "add-3")
    text = read_raws(house)["words"]
    assert (text.output, text.seed) == ("x found 12 of 1,300\n", 3)


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
