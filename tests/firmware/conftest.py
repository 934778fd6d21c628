"""What many of these tests begin with."""

from __future__ import annotations

import pytest

from sim2real.link.wire.messages import State
from tests.firmware.core.bench import PLAYS, TARGET, Bench


@pytest.fixture
def playing() -> Bench:
    """A bench in mid flight."""
    bench = Bench().armed()
    bench.send(bench.trajectory(TARGET))
    bench.run(PLAYS)
    assert bench.pwm != (0, 0) and bench.state == State.ARMED
    return bench
