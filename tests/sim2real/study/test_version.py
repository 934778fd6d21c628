"""The digest of the code changes with every source that a study depends on, and with nothing else."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

import sim2real
from sim2real.study.version import OF_GAMES, OF_STUDIES, code_version

ROOT = Path(sim2real.__file__).parents[1]
PLAYED = """
import sys
from pathlib import Path
from sim2real.table.meetings import Meeting, play_meeting

game = Meeting("policy:table_champion", "interceptor", "match-v0", 1, 0.2, concealed="everything", clears=True)
play_meeting(game, None)
own = ("agents", "baselines", "firmware", "puckpilot_env", "sim2real")
files = [one.__file__ for name, one in list(sys.modules.items()) if name.split(".")[0] in own]
print(*sorted(Path(one).relative_to(Path.cwd()).as_posix() for one in files if one))
"""


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


def test_a_game_depends_on_its_players_and_the_board_s_program_and_not_on_the_diagnosis(tmp_path: Path):
    seen = [code_version(tmp_path, OF_GAMES)]
    for name in ("baselines/players/a.py", "firmware/build/board.elf"):
        (tmp_path / name).parent.mkdir(parents=True)
        (tmp_path / name).write_bytes(b"1")
        seen.append(code_version(tmp_path, OF_GAMES))
    assert len(set(seen)) == 3
    (tmp_path / "sim2real/diagnose").mkdir(parents=True)
    (tmp_path / "sim2real/diagnose/a.py").write_text("x = 1\n")
    assert code_version(tmp_path, OF_GAMES) == seen[-1]


@pytest.mark.slow
def test_all_that_plays_a_game_is_in_its_version() -> None:
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    loaded = subprocess.run([sys.executable, "-c", PLAYED], capture_output=True, text=True, check=True, cwd=ROOT).stdout
    outside = [one for one in loaded.split() if not any(one.startswith(f"{folder}/") for folder in OF_GAMES)]
    assert "sim2real/table/meetings.py" in loaded.split() and all((ROOT / folder).is_dir() for folder in OF_GAMES)
    assert set(outside) == {"sim2real/__init__.py", "sim2real/study/__init__.py", "sim2real/study/version.py"}
