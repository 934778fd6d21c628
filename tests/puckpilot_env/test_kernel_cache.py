"""A cache of compiled kernels that a full disk or a kill has damaged is made anew."""

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


@pytest.mark.parametrize(("ending", "keeps"), [("nbi", 20), ("nbc", 0)])
def test_a_damaged_file_is_compiled_anew(tmp_path: Path, ending: str, keeps: int) -> None:
    (tmp_path / "some_kernels.py").write_text(MODULE)
    words = [sys.executable, "-c", "import some_kernels"]
    there = {
        **os.environ,
        "XDG_CACHE_HOME": str(tmp_path / "cache"),
        "PYTHONPATH": os.pathsep.join([str(tmp_path), *sys.path]),
    }
    assert subprocess.run(words, env=there, capture_output=True, text=True, check=True).stdout == "6.0\n"
    files = list((tmp_path / "cache").rglob(f"*twice*.{ending}"))
    assert files
    for file in files:
        file.write_bytes(file.read_bytes()[:keeps])
    for _ in range(2):  # damaged, and made anew
        done = subprocess.run(words, env=there, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout, done.stderr) == (0, "6.0\n", "")
    assert all(file.stat().st_size > keeps for file in files)
