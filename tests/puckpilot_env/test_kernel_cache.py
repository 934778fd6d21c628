"""A cache of compiled kernels: copies share it, and one that a full disk or a kill has damaged is made anew."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

pytestmark = pytest.mark.slow

MODULE = """
from puckpilot_env.kernel import kernel

@kernel
def twice(x):
    return 2.0 * x

print(twice(3.0))
"""


def run(home: Path) -> subprocess.CompletedProcess[str]:
    """The program in a folder, in a process whose cache lies beside it."""
    there = {
        **os.environ,
        "XDG_CACHE_HOME": str(home.parent / "cache"),
        "PYTHONPATH": os.pathsep.join([str(home), *sys.path]),
    }
    words = [sys.executable, "-c", "import some_kernels"]
    return subprocess.run(words, env=there, capture_output=True, text=True, check=False)


def files_of_twice(home: Path, ending: str) -> list[Path]:
    """What is kept of the program's kernel."""
    return list((home.parent / "cache").rglob(f"*twice*.{ending}"))


def test_another_copy_of_the_same_program_finds_what_was_compiled_and_an_edited_one_does_not(tmp_path: Path) -> None:
    homes = [tmp_path / name for name in ("one", "other", "edited")]
    for home, text in zip(homes, (MODULE, MODULE, MODULE.replace("2.0", "3.0")), strict=True):
        home.mkdir()
        (home / "some_kernels.py").write_text(text)
    written: list[int] = []
    for home, printed in zip(homes, ("6.0\n", "6.0\n", "9.0\n"), strict=True):
        assert run(home).stdout == printed
        (file,) = files_of_twice(home, "nbc")
        written.append(file.stat().st_mtime_ns)
    assert written[0] == written[1] != written[2]


@pytest.mark.parametrize(("ending", "keeps"), [("nbi", 20), ("nbc", 0)])
def test_a_damaged_file_is_compiled_anew(tmp_path: Path, ending: str, keeps: int) -> None:
    home = tmp_path / "home"
    home.mkdir()
    (home / "some_kernels.py").write_text(MODULE)
    assert run(home).stdout == "6.0\n"
    files = files_of_twice(home, ending)
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:keeps])
    for _ in range(2):  # damaged, and made anew
        done = run(home)
        assert (done.returncode, done.stdout, done.stderr) == (0, "6.0\n", "")
    assert all(file.stat().st_size > keeps for file in files)
