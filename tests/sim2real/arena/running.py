"""An arena in a process of its own, as somebody starts it."""

from __future__ import annotations

import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def arena(*options: str) -> Iterator[str]:
    """The address of an arena at a free port; it ends with the context."""
    command = [sys.executable, "-m", "puckpilot", "arena", "--port", "0", *options]
    with subprocess.Popen(command, stdout=subprocess.PIPE, text=True) as process:
        assert process.stdout is not None
        try:
            yield process.stdout.readline().split()[0]
            process.terminate()
            assert process.wait(20.0) == 128 + signal.SIGTERM
        finally:
            process.kill()
