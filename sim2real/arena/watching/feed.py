"""What a game hands over to the process that lets pages watch it, without waiting for that."""

from __future__ import annotations

import contextlib
import os
import subprocess
import sys
from importlib.util import find_spec

ENDING = 5.0  # s that the server may take to say goodbye to its pages


class Feed:
    """A server in a process of its own at a `port` of this machine, 0 for any that is free; `address`: with the token.

    ValueError, in one line, where it cannot listen; ModuleNotFoundError without aiohttp.
    """

    def __init__(self, port: int) -> None:
        if find_spec("aiohttp") is None:
            raise ModuleNotFoundError("No module named 'aiohttp'", name="aiohttp")
        pipe = subprocess.PIPE
        self._process = subprocess.Popen(
            (sys.executable, "-m", "sim2real.arena.watching.relay", str(port)),
            stdin=pipe, stdout=pipe, process_group=0,  # Ctrl-C is not for it: the game ends first
        )  # fmt: skip
        assert self._process.stdin and self._process.stdout
        self.address = self._process.stdout.readline().decode().strip()
        if not self.address.startswith("http"):
            self.close()
            raise ValueError(self.address or "the server for those who watch did not start; its error is above")
        self._pipe = self._process.stdin.fileno()
        os.set_blocking(self._pipe, False)

    def put(self, message: str) -> None:
        """Hand a message over; dropped where the server does not take it at once, or is gone.

        A write of less than PIPE_BUF bytes is taken whole or not at all."""
        with contextlib.suppress(BlockingIOError, BrokenPipeError):
            os.write(self._pipe, message.encode() + b"\n")

    def close(self) -> None:
        """Let the pages go, and end the server."""
        process = self._process
        assert process.stdin and process.stdout
        with contextlib.suppress(BrokenPipeError):
            process.stdin.close()
        try:
            process.wait(ENDING)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        process.stdout.close()
