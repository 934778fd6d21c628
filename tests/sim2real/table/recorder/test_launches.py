"""Launches: classes and counts by hand, and what a straight puck with one wall contact is seen as."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.table.backend import SeenFrame
from sim2real.table.recorder.launch_coverage import ALONG, HEADINGS, SPEEDS, Launch, LaunchCoverage
from sim2real.table.recorder.launch_watcher import LaunchWatcher


def test_a_launch_is_counted_in_its_classes() -> None:
    coverage = LaunchCoverage(2.0, 1.0)
    coverage.add((1.9, 0.9, -2.0, 2.0))
    (launch,) = coverage.launches
    assert launch == Launch(list(SPEEDS).index("fast"), HEADINGS.index("robot and left"), 2, 1)
    assert launch.words == "fast (1.8 to 3.5 m/s), from the opponent's end, robot's left, towards robot and left"
    assert "middle" in coverage.missing and "opponent's end" not in coverage.missing
    assert "robot's left" in coverage.missing[-1] and "contacts with the walls" in coverage.missing[-1]


def test_what_is_asked_for_next_covers_everything() -> None:
    coverage, random = LaunchCoverage(2.0, 1.0), np.random.default_rng(1)
    for _ in range(len(HEADINGS)):
        launch = coverage.next(random)
        puck = coverage.motion(launch, 0.05, random)
        coverage.add((puck[0], puck[1], puck[2], puck[3]))
        assert coverage.launches[-1] == launch
    assert coverage.counts("heading").tolist() == [1] * len(HEADINGS)
    assert coverage.counts("speed").min() >= 2 and coverage.counts("along").min() >= 8 // len(ALONG)
    assert coverage.missing == ["4 contacts with the walls at robot's end, opponent's end, robot's right, robot's left"]


def watched(places: np.ndarray) -> LaunchCoverage:
    """What is counted of a puck at `places` (frames, 2) [m], 120 a second."""
    coverage = LaunchCoverage(2.0, 1.0)
    watcher = LaunchWatcher(coverage, 0.03)
    for k, place in enumerate(places):
        watcher.take(SeenFrame(k / 120.0, (float(place[0]), float(place[1])), None))
    return coverage


@pytest.mark.parametrize(("speed", "wall"), [(0.5, "yW"), (3.0, "yW"), (-0.5, "y0"), (-3.0, "y0")])
def test_a_launch_with_a_wall_contact(speed: float, wall: str) -> None:
    t = np.arange(60) / 120.0
    free = 0.3 + abs(speed) * np.maximum(t - 0.1, 0.0)  # at rest, then launched towards y = 0.97
    y = np.minimum(free, 0.5)
    y = np.where(free > 0.5, 1.0 - free, y) + 0.47  # mirrored at the wall
    coverage = watched(np.column_stack([np.full(60, 0.8), y if speed > 0.0 else 1.0 - y]))
    assert len(coverage.launches) == 1
    assert coverage.contacts == {name: int(name == wall and abs(speed) > 1.0) for name in ("x0", "xL", "y0", "yW")}


def test_a_puck_at_rest_is_no_launch() -> None:
    noise = 0.0003 * np.random.default_rng(3).standard_normal((200, 2))
    assert not watched(0.5 + noise).launches
