"""What holds for all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

# Set before numpy is imported: as in `puckpilot.py`, and because every worker of the tests has a core of its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

FIRST = ("test_command.py", "test_house.py", "sim2real/vision/calibrate", "test_")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that stand in tests/ itself first: their longest tests would keep one worker busy at the end. The
    very first compiles the simulator, which the next do without, so that the workers do not both compile it."""
    here = Path(__file__).parent

    def place(item: pytest.Item) -> int:
        path = item.path.relative_to(here).as_posix()
        return next((number for number, start in enumerate(FIRST) if path.startswith(start)), len(FIRST))

    items.sort(key=place)
