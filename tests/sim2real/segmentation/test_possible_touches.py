"""Possible touches of the robot's mallet: of a puck that passes, by hand, and about contacts."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.regimes.base import Evidence
from sim2real.diagnose.regimes.gantry.regime import _disturbed_times
from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.events import ContactEvent
from sim2real.segmentation.possible_touches import possible_touches
from sim2real.segmentation.segments import segment

RADII = 0.0309 + 0.0505  # m
META = {"puck": {"radius_m": 0.0309}, "mallet": {"radius_m": 0.0505}, "table": {"length_m": 2.0, "width_m": 1.0}}


def recording(gap: float, speed: float) -> Recording:
    """A mallet at rest at (0.5, 0.5) and a puck that passes it along x in a second, `gap` [m] away when it is
    nearest, half-way between two of the frames."""
    t = np.arange(120) / 120.0
    x, y = 0.5 + speed * (t - 0.5 - 1.0 / 240.0), np.full(120, 0.5 + RADII + gap)
    blank, still = np.full(120, np.nan), np.full(120, 0.5)
    frames = {"t": t, "puck_x": x, "puck_y": y, "opponent_x": blank, "opponent_y": blank}
    return Recording("passing", META, Stream(frames), Stream({"t": t, "mallet_x": still, "mallet_y": still.copy()}))


def test_a_puck_that_stays_clear_touches_nothing() -> None:
    one = recording(0.05, 1.0)
    assert len(possible_touches(one, segment(one))) == 0


@pytest.mark.parametrize("speed", [0.4, 1.0])
def test_a_touch_that_no_contact_explains_is_given_with_what_is_around_it(speed: float) -> None:
    one = recording(0.0, speed)
    found = possible_touches(one, replace(segment(one), contacts=()))
    nearest = 0.5 + 1.0 / 240.0
    assert found[0] < nearest - 0.01 and found[-1] > nearest + 0.01
    assert np.diff(found).max() < 0.003  # so that no window of the mallet's path is left in between
    away = np.hypot(speed * (found - nearest), RADII) - RADII
    assert away.max() < 0.02  # m; the puck was near at all of them


def test_about_a_contact_whose_time_is_known_to_milliseconds_there_are_touches_wherever_the_puck_was_seen() -> None:
    one, still = recording(0.2, 1.0), np.zeros(2)
    hit = ContactEvent("mallet", "robot", 0.5, 0.5, 0.58, still, still, 0.01, (60, 61), 0.0, True)
    found = possible_touches(one, replace(segment(one), contacts=(hit,)))
    assert found[0] < 0.4925 and found[-1] > 0.5075 and np.diff(found).max() < 0.003


def test_places_between_two_hits_which_no_path_explains_are_touches() -> None:
    one = recording(0.0, 1.0)
    segments = replace(segment(one), contacts=())
    wild = np.abs(np.arange(120) - 60) < 3
    np.testing.assert_array_equal(possible_touches(one, replace(segments, wild=wild)), possible_touches(one, segments))


def test_the_gantry_takes_them_from_frames_on_the_encoders_clock() -> None:
    """Its paths come with the frames as they were recorded, here 15 ms late; the segments are of corrected ones."""
    one = recording(0.0, 1.0)
    assert one.frames is not None
    late = replace(one, frames=Stream({**one.frames.columns, "t": one.frames.t + 0.015}))
    segments = replace(segment(one), contacts=())
    evidence = Evidence([one], [segments], [], [late], {})
    (found,) = _disturbed_times(evidence)
    np.testing.assert_array_equal(found, possible_touches(one, segments))
    assert abs(0.5 * (found[0] + found[-1]) - 0.5 - 1.0 / 240.0) < 0.002


def test_a_wrong_place_does_not_make_its_neighbours_touches() -> None:
    one = recording(0.3, 1.0)
    assert one.frames is not None
    one.frames["puck_x"][60] += 1.0
    wild = np.arange(120) == 60
    assert len(possible_touches(one, replace(segment(one), contacts=(), wild=wild))) == 0
