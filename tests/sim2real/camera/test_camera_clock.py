"""The camera's clock, on stamps with injected offsets, drifts and heavy-tailed delays."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.camera.camera_clock import CameraClock

PERIOD, LEAST = 1.0 / 120.0, 4e-3


def stamps(seed: int, offset: float, drift: float, seconds: float = 12.0) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The camera's stamps, the host's times of the exposures, and of the arrivals [s]: late by LEAST and a lognormal
    time with a median of 0.3 ms, one in twenty by up to 30 ms more."""
    rng = np.random.default_rng(seed)
    exposed = 100.0 + np.arange(0.0, seconds, PERIOD)
    delay = LEAST + rng.lognormal(np.log(0.3e-3), 1.0, len(exposed))
    delay += (rng.random(len(exposed)) < 0.05) * rng.uniform(0.0, 0.03, len(exposed))
    return offset + (1.0 + drift) * (exposed - 100.0), exposed, np.maximum.accumulate(exposed + delay)


@pytest.mark.parametrize("seed", range(6))
def test_injected_offset_and_drift_come_back(seed: int) -> None:
    rng = np.random.default_rng(100 + seed)
    offset, drift = float(rng.uniform(-1e4, 1e4)), float(rng.uniform(-150e-6, 150e-6))
    camera, exposed, arrived = stamps(seed, offset, drift)
    clock = CameraClock(LEAST)
    for one, came in zip(camera, arrived, strict=True):
        clock.add(float(one), float(came))
    off = np.array([clock.to_host(float(one)) for one in camera]) - exposed
    assert np.abs(off).max() < 0.5e-3 and abs(off[-1]) < clock.error_s < 0.5e-3
    assert abs(clock.drift - drift) < min(20e-6, clock.drift_error)
    assert clock.to_camera(clock.to_host(float(camera[-1]))) == pytest.approx(float(camera[-1]), abs=1e-9)
    assert clock.jumps == 0


def test_without_a_known_delay_all_is_late_by_it() -> None:
    camera, exposed, arrived = stamps(0, 0.0, 0.0)
    clock = CameraClock()
    for one, came in zip(camera, arrived, strict=True):
        clock.add(float(one), float(came))
    assert clock.to_host(float(camera[-1])) - exposed[-1] == pytest.approx(LEAST, abs=0.5e-3)


@pytest.mark.parametrize("jump", [-3.0, 8e-3, 15.0])
def test_a_clock_that_jumps_is_followed_and_counted(jump: float) -> None:
    """For it, frames of 3 s after the jump suffice."""
    camera, exposed, arrived = stamps(1, 5.0, 30e-6, 6.0)
    clock = CameraClock(LEAST)
    for k, (one, came) in enumerate(zip(camera, arrived, strict=True)):
        clock.add(float(one) + (jump if k >= 360 else 0.0), float(came))
    assert clock.jumps > 0
    assert clock.to_host(float(camera[-1]) + jump) == pytest.approx(float(exposed[-1]), abs=0.5e-3)


@pytest.mark.parametrize("step", [5e-3, 40e-3, 0.1])
def test_frames_that_come_later_by_a_step_are_not_taken_for_fresh_ones(step: float) -> None:
    """Nor those that come as before again."""
    camera, exposed, arrived = stamps(2, 5.0, 30e-6, 9.0)
    clock, off = CameraClock(LEAST), []
    for k, (one, came) in enumerate(zip(camera, arrived, strict=True)):
        clock.add(float(one), float(came) + (step if 360 <= k < 720 else 0.0))
        off.append(clock.to_host(float(one)) - exposed[k])
    assert np.abs(np.array(off[120:])).max() < 3e-3 and abs(off[-1]) < 0.5e-3
    assert clock.jumps >= 1 and clock.late == pytest.approx(0.0, abs=1e-3)


@pytest.mark.parametrize("pause", [0.3, 0.8, 3.0])
@pytest.mark.parametrize("before", [0.3, 1.0])
def test_frames_that_waited_for_the_host_do_not_make_the_next_ones_late(before: float, pause: float) -> None:
    """A pause of the host, after which it takes the frames of the pause every 6 ms, one in twelve of them."""
    camera, exposed, arrived = stamps(3, 5.0, 30e-6, 8.0)
    end = exposed[0] + before + pause
    waited = np.flatnonzero((exposed > end - pause) & (exposed < end))[::12]
    taken = end + 0.006 * np.arange(len(waited))
    arrived[waited] = np.maximum(arrived[waited], taken)
    clock = CameraClock(LEAST)
    for k in sorted([*waited, *np.flatnonzero((exposed <= end - pause) | (exposed >= taken[-1]))]):
        clock.add(float(camera[k]), float(arrived[k]))
    assert clock.late == 0.0
    assert clock.to_host(float(camera[-1])) == pytest.approx(float(exposed[-1]), abs=0.5e-3)


def test_before_the_first_frame_nothing_is_known() -> None:
    clock = CameraClock()
    assert clock.error_s == float("inf") == clock.drift_error and len(clock) == 0
    for ask in (clock.to_host, clock.to_camera):
        with pytest.raises(ValueError, match="the camera's clock is unknown: no frame has come yet"):
            ask(1.0)
