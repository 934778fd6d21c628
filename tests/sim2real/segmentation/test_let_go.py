"""Launches that begin in a hand, and those that begin in the midst of play, where hits follow each other too fast."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.segmentation.let_go import let_go

RATE = 120.0


def seen(pause: int, to: tuple[float, float], left_out: bool = False) -> tuple[np.ndarray, np.ndarray, list]:
    """A puck that moves at 2 m/s, is not seen for `pause` frames, which may be left out, and is then seen at `to` [m];
    the frames of both launches."""
    count = 20 + pause + 20
    t, p = np.arange(count) / RATE, np.full((count, 2), np.nan)
    p[:20] = np.stack([0.5 + 2.0 * t[:20], np.full(20, 0.4)], axis=1)
    p[20 + pause :] = to
    kept = np.isfinite(p[:, 0]) if left_out else np.ones(count, bool)
    start = 20 if left_out else 20 + pause
    return t[kept], p[kept], [(0, 20), (start, start + 20)]


@pytest.mark.parametrize(
    ("pause", "to", "left_out", "expected"),
    [
        (0, (1.4, 0.6), False, True),  # put there between two frames
        (2, (0.75, 0.45), False, False),  # two hits within three frames
        (60, (0.75, 0.45), False, True),  # half a second in hands
        (12, (1.1, 0.6), False, False),  # hidden for a tenth of a second
        (60, (1.4, 0.6), True, False),  # a launch of the holdout lies between
    ],
)
def test_what_lies_between_two_launches_says_who_let_the_puck_go(
    pause: int, to: tuple[float, float], left_out: bool, expected: bool
) -> None:
    assert let_go(*seen(pause, to, left_out)) == (True, expected)


def test_a_recording_without_a_puck_has_no_launches() -> None:
    assert let_go(np.zeros(0), np.zeros((0, 2)), []) == ()
