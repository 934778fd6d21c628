"""Build the microcontroller's program: generate both sides' messages from firmware/protocol.toml, and compile.

Needs make and arm-none-eabi-gcc.
"""

from __future__ import annotations

import argparse
import shutil
import subprocess


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command: none."""


def run(args: argparse.Namespace) -> int:
    """Build. Returns 0; raises ValueError, in one line, if that fails."""
    from firmware import ELF, FOLDER
    from firmware.definition import read_protocol
    from firmware.generate import write

    missing = [name for name in ("make", "arm-none-eabi-gcc") if not shutil.which(name)]
    if missing:
        packages = "make, gcc-arm-none-eabi and libnewlib-arm-none-eabi"
        raise ValueError(f"building needs {' and '.join(missing)}; install Debian's {packages}")
    for path in write(read_protocol()):
        print(f"wrote {path}")
    done = subprocess.run(["make", "-s", "-C", str(FOLDER), "f103"], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(f"the program does not build: {(done.stderr or done.stdout).strip().splitlines()[0]}")
    print(f"wrote {ELF}\n{done.stdout.strip()}")
    return 0
