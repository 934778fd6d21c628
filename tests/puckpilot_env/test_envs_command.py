"""`puckpilot envs`: the list, a page, both as JSON, and an unknown id."""

from __future__ import annotations

import argparse
import json
from pathlib import Path

import pytest

from puckpilot_env.commands import envs
from puckpilot_env.documentation import page
from puckpilot_env.variants import all_variants


def _run(*words: str) -> int:
    parser = argparse.ArgumentParser()
    envs.add_arguments(parser)
    return envs.run(parser.parse_args(words))


@pytest.fixture(autouse=True)
def narrow(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("COLUMNS", "80")


def test_the_list_names_every_id_in_80_columns(capsys: pytest.CaptureFixture[str]) -> None:
    assert _run() == 0
    out = capsys.readouterr().out
    assert all(f" {id_} " in out for id_ in all_variants())
    assert max(map(len, out.splitlines())) <= 80
    assert "\u2026" not in out, "a cell is cut short"


def test_a_page_is_printed_for_reading(capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("defence-v0") == 0
    out = capsys.readouterr().out
    assert "expected_0.5s_y" in out and "possession_lost" in out and "Version history" in out
    assert "| --- |" not in out


def test_json_of_one_and_of_all(capsys: pytest.CaptureFixture[str]) -> None:
    assert _run("match-v0", "--json") == 0
    one = json.loads(capsys.readouterr().out)
    assert _run("--json") == 0
    assert {entry["id"]: entry for entry in json.loads(capsys.readouterr().out)}["puckpilot/match-v0"] == one
    assert [column["name"] for column in one["observation"]][:2] == ["mallet_x", "mallet_y"]


def test_an_unknown_id_is_an_error_of_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(ValueError, match="did you mean 'puckpilot/match-v0'") as raised:
        _run("mach-v0")
    assert "\n" not in str(raised.value)
    assert capsys.readouterr().out == ""


def test_pages_are_written_anew(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(page.write_pages, "__defaults__", (tmp_path / "pages",))
    assert _run("--write-pages") == 0
    for old in page.FOLDER.glob("*.md"):
        assert (tmp_path / "pages" / old.name).read_text(encoding="utf-8") == old.read_text(encoding="utf-8")
    assert len(list((tmp_path / "pages").glob("*.png"))) == len(all_variants())
    assert str(tmp_path) in capsys.readouterr().out
