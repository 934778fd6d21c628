"""The digest of the code changes with every source that a study depends on, and with nothing else."""

from __future__ import annotations

from pathlib import Path

from sim2real.study.version import OF_GAMES, OF_STUDIES, code_version


def test_any_source_that_answers_or_cases_depend_on_counts(tmp_path: Path):
    files = ("sim2real/diagnose/a.py", "puckpilot_env/physics/b.py", "sim2real/study/independent_table/c.py")
    for name in files:
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_text("x = 1\n")
    seen = [code_version(tmp_path, OF_STUDIES)]
    for name in files:
        (tmp_path / name).write_text("x = 2\n")
        seen.append(code_version(tmp_path, OF_STUDIES))
    (tmp_path / files[0]).rename(tmp_path / "sim2real/diagnose/z.py")
    seen.append(code_version(tmp_path, OF_STUDIES))
    assert len(set(seen)) == 5
    (tmp_path / "sim2real/diagnose/notes.txt").write_text("no source")
    (tmp_path / "tests").mkdir()
    (tmp_path / "tests/test_other.py").write_text("x = 1\n")
    assert code_version(tmp_path, OF_STUDIES) == seen[-1]


def test_a_game_depends_on_its_players_and_the_board_s_program(tmp_path: Path):
    seen = [code_version(tmp_path, OF_GAMES)]
    for name in ("baselines/players/a.py", "firmware/build/board.elf"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_bytes(b"1")
        seen.append(code_version(tmp_path, OF_GAMES))
    assert len(set(seen)) == 3
