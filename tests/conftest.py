"""What holds for all tests."""

from __future__ import annotations

import os
from pathlib import Path

import pytest

# Set before numpy is imported: as in `puckpilot.py`, and because every worker of the tests has a core of its own.
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Put the files that stand in tests/ itself first: their longest tests would keep one worker busy at the end."""
    items.sort(key=lambda item: item.path.parent != Path(__file__).parent)
