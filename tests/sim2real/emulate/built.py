"""Programs for the emulator, built once a session from this tree: the real one, and one with a plain core."""

from __future__ import annotations

import shutil
import subprocess
from functools import cache
from pathlib import Path
from tempfile import mkdtemp

import pytest

from firmware import FOLDER

PLAIN_CORE = Path(__file__).parent / "plain_core"


@cache
def built(core: Path = FOLDER / "core") -> Path:
    """The ELF of the board's support code with the core in this folder."""
    if not shutil.which("arm-none-eabi-gcc") or not shutil.which("make"):
        pytest.skip("no arm-none-eabi-gcc, or no make, here: the microcontroller's program cannot be built")
    pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")
    folder = Path(mkdtemp(prefix="firmware-"))
    make(folder, core)
    return folder / "program.elf"


def make(folder: Path, core: Path = FOLDER / "core", source: Path = FOLDER) -> str:
    """Build into `folder` by the Makefile; what it says."""
    words = [f"CORE={core}", f"BUILD={folder / 'build'}", f"ELF={folder / 'program.elf'}"]
    done = subprocess.run(["make", "-C", str(source), "f103", *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout


def plain() -> Path:
    """The ELF with the plain core, whose orders are in plain_core/robot.c."""
    return built(PLAIN_CORE)
