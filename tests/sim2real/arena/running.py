"""An arena in a process of its own, as somebody starts it, with a folder of its own unless it is given one."""

from __future__ import annotations

import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import sim2real

PAGE = Path(sim2real.__file__).with_name("arena") / "page"


@contextmanager
def arena(*options: str) -> Iterator[str]:
    """The address of an arena at a free port; it ends with the context."""
    command = [sys.executable, "-m", "puckpilot", "arena", "--port", "0"]
    with (
        tempfile.TemporaryDirectory() as folder,
        subprocess.Popen([*command, "--out", folder, *options], stdout=subprocess.PIPE, text=True) as process,
    ):
        assert process.stdout is not None
        try:
            yield process.stdout.readline().split()[0]
            process.terminate()
            assert process.wait(20.0) == 128 + signal.SIGTERM
        finally:
            process.kill()
