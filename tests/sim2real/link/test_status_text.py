"""The texts for the board's events."""

from __future__ import annotations

import pytest

from sim2real.link.status_text import drift_text, event_text
from sim2real.link.wire.messages import Event


@pytest.mark.parametrize(
    ("code", "detail", "message"),
    [
        (0, 36, "board started (cause 36)"),
        (1, 3, "board is ARMED"),
        (2, 1, "board stopped: ESTOP"),
        (3, 0x0805, "board refused traj: WRONG_STATE"),
        (3, 0x0403, "it does not hold the configuration sent last: send that again, then arm"),
        (9, 7, "event 9, detail 7"),
    ],
)
def test_an_event_in_words(code: int, detail: int, message: str):
    assert message in event_text(Event(0, code, detail))


def test_a_drift_that_is_noise_is_no_number():
    assert drift_text(-2300.0, 4000.0) == drift_text(5.0, float("inf")) == "drift not known yet"
    assert drift_text(-12.34, 20.0) == "12.3 ppm slow (to 20 ppm)"
