"""The frame monitor names what is wrong with frames, and reports nothing for good ones."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.camera.frame import Frame
from sim2real.camera.frame_monitor import EVERY, STALL, Check, FrameMonitor, Trouble
from sim2real.camera.grey_image import read_grey
from tests.places import UBC

PHOTOGRAPHS = UBC / "calibration"
RANDOM = np.random.default_rng(4)
GOOD = (60 + 5 * RANDOM.standard_normal((120, 160))).astype(np.uint8)


def names(monitor: FrameMonitor, image: np.ndarray, now: float = 5.0) -> list[str]:
    """What it calls what is wrong with an image."""
    return [trouble.name for trouble in monitor.check(Frame(image, now, now, 0), now)]


def test_a_good_picture_is_no_trouble() -> None:
    assert names(FrameMonitor((160, 120)), GOOD) == [] == names(FrameMonitor(), GOOD)


def test_a_picture_that_comes_twice_is_noticed() -> None:
    monitor = FrameMonitor()
    assert [names(monitor, image, k / 100) for k, image in enumerate((GOOD, GOOD.copy(), GOOD + 1, GOOD))] == [
        [],
        ["repeated"],
        [],
        [],
    ]


def test_a_slow_camera_is_not_stalled() -> None:
    monitor = FrameMonitor()
    for k in range(3):
        assert names(monitor, GOOD + k, k / 8) == []
    assert monitor.check(None, 2 / 8 + 0.6) == []
    assert [trouble.name for trouble in monitor.check(None, 2 / 8 + 0.7)] == ["stalled"]


def test_without_a_size_all_pictures_have_that_of_the_first() -> None:
    monitor = FrameMonitor()
    assert names(monitor, GOOD) == [] and names(monitor, GOOD[:-1], 6.0) == ["wrong size"]


def test_a_stall_is_noticed_when_it_lasts_and_ends_with_a_frame() -> None:
    monitor = FrameMonitor()
    assert monitor.check(None, 100.0) == []  # it has only begun to look
    (trouble,) = monitor.check(None, 100.0 + 2.0 * STALL)
    assert trouble.name == "stalled" and "0.2 s" in trouble.text
    assert monitor.check(Frame(GOOD, 7.0, 101.0, 0), 101.0) == []
    assert monitor.check(None, 101.0 + 0.9 * STALL) == []
    assert [t.name for t in monitor.check(None, 101.0 + 1.1 * STALL)] == ["stalled"]


@pytest.mark.parametrize("image", [GOOD.astype(np.uint16), np.stack([GOOD] * 3, axis=2), GOOD.astype(float)])
def test_a_wrong_type_is_named_with_what_came(image: np.ndarray) -> None:
    (trouble,) = FrameMonitor().check(Frame(image, 0.0, 0.0, 0), 0.0)
    assert trouble.name == "wrong type" and str(image.shape) in trouble.text and str(image.dtype) in trouble.text


def test_a_wrong_size_is_named_with_both_sizes() -> None:
    (trouble,) = FrameMonitor((120, 160)).check(Frame(GOOD, 0.0, 0.0, 0), 0.0)
    assert trouble.name == "wrong size" and "160 x 120" in trouble.text and "120 x 160" in trouble.text


def test_too_much_white_is_over_exposed_and_a_puck_is_not() -> None:
    image = GOOD.copy()
    image[20:30, 30:40] = 255  # 0.5 %
    assert names(FrameMonitor(), image) == []
    image[50:90, 30:60] = 255
    assert names(FrameMonitor(), image) == ["over-exposed"]


def test_raw_pixels_of_a_colour_sensor_are_noticed() -> None:
    image = GOOD.copy()
    image[::2, ::2] = image[::2, ::2] * 0.6
    assert names(FrameMonitor(), image) == ["colour mosaic"]


@pytest.mark.parametrize(("view", "expected"), [(1, ["colour mosaic"]), (2, []), (3, [])])
def test_the_real_tables_photographs(view: int, expected: list[str]) -> None:
    """The first of them is a raw mosaic: its four kinds of pixels have 41, 67, 67 and 109 where the table is even."""
    if not PHOTOGRAPHS.is_dir():
        pytest.skip(f"the shared recordings are not beside this checkout ({PHOTOGRAPHS})")
    assert names(FrameMonitor((2048, 1536)), read_grey(PHOTOGRAPHS / f"view_{view}" / "view.png")) == expected


def test_pixels_are_looked_at_now_and_then_until_a_check_finds_something() -> None:
    seen = []

    def moved(image: np.ndarray) -> Trouble | None:
        seen.append(image)
        return Trouble("moved", "the markers are 9 pixels off; calibrate again")

    def blind(image: np.ndarray) -> Trouble | None:
        raise AssertionError("the first check has found something")

    monitor = FrameMonitor(checks=[lambda image: None, moved, blind])
    assert names(monitor, GOOD, 1.0) == ["moved"]
    assert names(monitor, GOOD + 1, 1.0 + 0.9 * EVERY) == []
    assert names(monitor, GOOD, 1.0 + 1.1 * EVERY) == ["moved"]
    assert len(seen) == 2 and seen[0] is GOOD


def test_pixels_can_be_checked_after_a_frame_was_used_one_check_at_a_time() -> None:
    seen = []

    def check(name: str) -> Check:
        return lambda image: seen.append(name)

    monitor = FrameMonitor(checks=[check("first"), check("second")])
    for number, done in ((0, 1), (1, 2), (2, 2)):
        frame = Frame(GOOD + number, 1.0 + 0.1 * number, 1.0 + 0.1 * number, number)
        assert monitor.check_arrival(frame) == [] and len(seen) == min(number, done)
        assert monitor.check_pixels(frame) == [] and seen == ["first", "second"][:done]
    late = Frame(GOOD, 2.0, 1.1 + EVERY, 3)
    assert monitor.check_pixels(late) == [] and seen == ["first", "second", "first"]
