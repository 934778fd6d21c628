"""What holds for all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

# Set before numpy is imported: as in `puckpilot.py`, and because every worker of the tests has a core of its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")

FIRST = ("test_command.py", "test_house.py")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that stand in tests/ itself first: their longest tests would keep one worker busy at the end. The
    very first compiles the simulator, which the second does without, so that the workers do not both compile it."""
    items.sort(key=lambda item: FIRST.index(item.path.name) if item.path.name in FIRST else len(FIRST))
    items.sort(key=lambda item: item.path.parent != Path(__file__).parent)
