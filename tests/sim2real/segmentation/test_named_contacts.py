"""Attribution of contacts when the recording does not state all sizes."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.parameters import BY_NAME
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.causes import mallet_tracks
from sim2real.segmentation.segments import segment
from tests.sim2real.diagnose.synthetic import LENGTH, META, WIDTH, bouncing, recorded

T = np.arange(10) / 100
BLANK = np.full(10, np.nan)


def test_goals_of_unknown_width_leave_the_middle_of_the_ends_unexplained():
    """Pucks shot at the ends, at the sides and where a goal may be: wall and post are indistinguishable there."""
    across = np.linspace(0.08, 0.92, 28) * WIDTH
    launches = np.stack([np.full(28, 0.6), across, np.full(28, 2.0), np.zeros(28)], axis=1)
    recording, _ = recorded(*bouncing(launches, 1.0), np.random.default_rng(1), 0.0005)
    open_goals = replace(recording, meta={**META, "table": {**META["table"], "goal_width_m": None}})
    known, unknown = (segment(one).contacts for one in (recording, open_goals))
    assert [contact.kind for contact in known] == 28 * ["wall"]
    half_goal = BY_NAME["goal_width"].default / 2
    for contact in unknown:
        off = abs(contact.y - WIDTH / 2)
        assert contact.x == pytest.approx(LENGTH, abs=0.05)
        if off < half_goal + META["puck"]["radius_m"]:
            assert (contact.kind, contact.where) == ("unexplained", "x1 or a post")
        elif off > 0.3 * WIDTH:
            assert contact.kind == "wall"
    assert len(unknown) == 28


@pytest.mark.parametrize(
    "x, y", [(T, BLANK), (BLANK, BLANK), (np.where(T > 0.05, np.nan, T), np.where(T < 0.05, np.nan, T))]
)
def test_a_mallet_that_was_hardly_ever_seen_has_no_track(x, y):
    frames = Stream({"t": T, "puck_x": T, "puck_y": T, "opponent_x": x, "opponent_y": y})
    mallet = Stream({"t": T, "mallet_x": x, "mallet_y": y})
    assert mallet_tracks(Recording("unseen", META, frames, mallet), T) == {}
