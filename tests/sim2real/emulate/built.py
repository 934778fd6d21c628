"""Programs for the emulator: the one that is flashed, and one with a plain core. Both are committed, so that a machine
without the compiler runs them too; where it is installed, `make` builds them anew."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import pytest

from firmware import FOLDER

PLAIN_CORE = Path(__file__).parent / "plain_core"
PLAIN = PLAIN_CORE / "program.elf"  # its orders are in plain_core/robot.c
VERSION = "12.2.1"  # of the compiler that built what is committed


def need_compiler() -> None:
    """Skip, with the reason, where what is committed cannot be built byte for byte."""
    if not shutil.which("arm-none-eabi-gcc") or not shutil.which("make"):
        pytest.skip("arm-none-eabi-gcc or make is not installed (Debian: gcc-arm-none-eabi): nothing is rebuilt here")
    headers = subprocess.run(
        ["arm-none-eabi-gcc", "-E", "-"], input="#include <string.h>", capture_output=True, text=True
    )
    if headers.returncode:
        pytest.skip("arm-none-eabi-gcc has no C headers (Debian: libnewlib-arm-none-eabi): nothing is rebuilt here")
    version = subprocess.run(["arm-none-eabi-gcc", "-dumpfullversion"], capture_output=True, text=True, check=True)
    if version.stdout.strip() != VERSION:
        pytest.skip(
            f"arm-none-eabi-gcc is {version.stdout.strip()}; what is committed was built by Debian 12's {VERSION}"
        )


def make(folder: Path, core: Path = FOLDER / "core", source: Path = FOLDER) -> str:
    """Build into `folder` by the Makefile; what it says."""
    words = [f"CORE={core}", f"BUILD={folder / 'build'}", f"ELF={folder / 'program.elf'}"]
    done = subprocess.run(["make", "-C", str(source), "f103", *words], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout + done.stderr
    return done.stdout
