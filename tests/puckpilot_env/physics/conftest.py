"""How much is tried: PUCKPILOT_HYPOTHESIS=long multiplies every number of cases by 20."""

from __future__ import annotations

import os

import pytest
from hypothesis import HealthCheck, settings

settings.register_profile("short", deadline=None, derandomize=True, max_examples=200)
settings.register_profile(
    "long", deadline=None, derandomize=False, max_examples=4000, suppress_health_check=list(HealthCheck)
)
LONG = os.environ.get("PUCKPILOT_HYPOTHESIS", "short") == "long"
settings.load_profile("long" if LONG else "short")


@pytest.fixture(scope="session")
def effort() -> int:
    """The factor by which sweeps are lengthened."""
    return 20 if LONG else 1
