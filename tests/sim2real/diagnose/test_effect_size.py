"""The size of an effect: of a listed law its own, also beside a smooth term that the simulator cannot represent."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from sim2real.diagnose.effect_size import effect_size

SIZE, NOISE = 0.0018, 0.0005
UNITS = SimpleNamespace(of=lambda clusters: np.arange(4), freedom=np.full(4, 100.0))
PROBLEM: Any = SimpleNamespace(units=UNITS, noise_m=NOISE)
REGIME: Any = SimpleNamespace(size=lambda problem, found, other: SIZE)


def model(smooth: str | None, parameters: dict[str, float]) -> Any:
    """A search result whose smooth term explains 1600 units of squared noise in 400 residuals."""
    return SimpleNamespace(
        unlisted=smooth, clusters=np.arange(4), effect_parameters=lambda: parameters, gained=lambda units: 1600.0
    )


@pytest.mark.parametrize(
    ("found", "other", "expected"),
    [
        (model(None, {}), model(None, {}), SIZE),
        (model("spin", {}), model("spin", {}), SIZE),  # a listed law is left out, the smooth term stays
        (model("spin", {}), model(None, {}), 2.0 * NOISE),  # the smooth term is left out: sqrt(1600 / 400) noises
        (model("force", {"unlisted_force": 1.0}), model(None, {}), SIZE),
    ],
)
def test_the_size_is_that_of_the_law_that_is_left_out(found: Any, other: Any, expected: float) -> None:
    assert effect_size(REGIME, PROBLEM, found, other) == pytest.approx(expected)
