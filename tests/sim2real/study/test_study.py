"""`puckpilot study` from end to end, with a script as the diagnosis that logs the files that it can see."""

from __future__ import annotations

import argparse
import json
import shlex
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from sim2real.commands import study
from sim2real.study.confusion import Confusion

SCRIPT = """
import json, pathlib, sys
recording, out = pathlib.Path(sys.argv[2]), pathlib.Path(sys.argv[4])
with open({log!r}, "a") as log:
    print(json.dumps([str(recording), sorted(str(p.name) for p in recording.parent.rglob("*"))]), file=log)
if {stop!r} and len(open({log!r}).readlines()) > 1:
    raise SystemExit("cannot")
out.mkdir()
(out / "diagnosis.json").write_text(json.dumps(dict(verdict="agrees", findings=[])))
"""
FILES = {"meta.json", "frames.csv", "mallet.csv", "commands.csv", "drive.csv"}


def script(folder: Path, stop: bool = False) -> tuple[str, Path]:
    log = folder / "log"
    (folder / "tool.py").write_text(SCRIPT.format(log=str(log), stop=stop))
    return shlex.join([sys.executable, str(folder / "tool.py")]), log


def call(*words: str) -> int:
    parser = argparse.ArgumentParser()
    study.add_arguments(parser)
    return study.run(parser.parse_args([*words, "--seconds", "2", "--workers", "1", "--seed", "4"]))


@pytest.mark.slow
def test_a_study_asks_blindly_scores_and_goes_on_where_it_stopped(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    out = tmp_path / "out"
    tool, log = script(tmp_path, stop=True)
    words = ["--cases", "3", "--out", str(out), "--tool", tool]
    assert call(*words, "--json") == 1  # two cases without a diagnosis
    expected = json.loads(capsys.readouterr().out)
    assert [case["verdict"] for case in expected["cases"]] == ["agrees", "failed", "failed"]
    assert expected["cases"][1]["error"] == "cannot"
    seen = [json.loads(line) for line in log.read_text().splitlines()]
    for recording, files in seen:
        assert "case_" not in recording and str(out) not in recording
        assert set(files) <= {*FILES, "seen"} and "frames.csv" in files
    script(tmp_path)
    call(*words)
    words_said = capsys.readouterr().out
    assert "named right, one effect" in words_said and "confusion.png" in words_said
    assert len(log.read_text().splitlines()) == 3 + 2  # a case with a diagnosis is not diagnosed again
    written = json.loads((out / "study.json").read_text())
    assert [case["verdict"] for case in written["cases"]] == ["agrees"] * 3
    assert (out / "confusion.png").stat().st_size > 5000
    with pytest.raises(ValueError, match=r"another study \(mechanism None\)"):
        call(*words, "--mechanism", "table_tilt")
    capsys.readouterr()
    call("--cases", "4", *words[2:], "--json")  # the study continues with more cases
    assert (
        "contains this study with 3 cases: study.json and confusion.png are rewritten for 4" in capsys.readouterr().err
    )
    assert len(log.read_text().splitlines()) == 6
    plan = json.loads((out / "plan.json").read_text())
    (out / "plan.json").write_text(json.dumps({**plan, "code": "older"}))
    with pytest.raises(ValueError, match=r"another study \(code older\)"):
        call(*words)


@pytest.mark.long
def test_a_study_of_one_kind_counts_silence_as_right(tmp_path: Path, capsys: pytest.CaptureFixture[str]):
    tool, _ = script(tmp_path)
    words = ["--cases", "2", "--only", "nothing", "--out", str(tmp_path / "out"), "--tool", tool]
    assert call(*words, "--json") == 0
    figures = {figure["name"]: figure for figure in json.loads(capsys.readouterr().out)["figures"]}
    assert figures["nothing missing, no finding"]["value"] == 1.0
    assert figures["false alarms where nothing is missing"]["count"] == 2
    call(*words)
    alarms = next(line for line in capsys.readouterr().out.splitlines() if "false alarms" in line)
    assert alarms.rstrip().endswith("too few cases")  # none of two


@pytest.mark.parametrize(
    "said, title",
    [("undetermined", "diagnosed as undetermined"), ("side_force", "diagnosed as something else (rows: truth,")],
)
def test_silence_is_no_mistaken_name(said: str, title: str):
    counts = Confusion(("table_tilt",), (said, "table_tilt"), ((2, 3),))
    expected = study._confusion(SimpleNamespace(confusion=counts))  # pyright: ignore[reportArgumentType] - all it reads
    assert expected.title.startswith(title)


def test_what_cannot_be_studied_is_said_in_one_line(tmp_path: Path):
    with pytest.raises(ValueError, match=r"unknown mechanism 'gremlins'"):
        call("--cases", "1", "--out", str(tmp_path / "out"), "--mechanism", "gremlins")
    with pytest.raises(ValueError, match=r"--tool nosuchtool: there is no such program"):
        call("--cases", "1", "--out", str(tmp_path / "none"), "--tool", "nosuchtool -v")
    assert not (tmp_path / "none").exists()
    with pytest.raises(ValueError, match=r"--cases is 0"):
        call("--cases", "0", "--out", str(tmp_path / "out"))
