"""Estimated motions of a mallet from noisy samples of a known path."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.recording.folder import Recording, Stream
from sim2real.segmentation.mallet_path import MalletPath, opponent_path, robot_path
from tests.sim2real.diagnose.synthetic import META

NOISE = 0.0001
SWING, TURN = 0.3, 6.0  # m, rad/s: up to 1.8 m/s and 10.8 m/s^2


def swinging(rate: float, seconds: float = 12.0) -> tuple[np.ndarray, np.ndarray]:
    """Times (n,) [s] and noisy places (n, 2) [m] of a mallet that goes round an ellipse."""
    t = np.arange(int(seconds * rate)) / rate
    place = np.stack([0.5 + SWING * np.cos(TURN * t), 0.5 + 0.5 * SWING * np.sin(TURN * t)], axis=1)
    return t, place + np.random.default_rng(1).normal(0.0, NOISE, place.shape)


def path_of(who: str, rate: float) -> MalletPath | None:
    t, place = swinging(rate)
    nobody = np.full(len(t), np.nan)
    frames = {"t": t, "puck_x": nobody, "puck_y": nobody, "opponent_x": nobody, "opponent_y": nobody}
    if who == "opponent":
        seen = Stream({**frames, "opponent_x": place[:, 0], "opponent_y": place[:, 1]})
        return opponent_path(Recording("one", META, seen))
    mallet = Stream({"t": t, "mallet_x": place[:, 0], "mallet_y": place[:, 1]})
    return robot_path(Recording("one", META, Stream(frames), mallet))


@pytest.mark.parametrize(("who", "rate"), [("opponent", 120.0), ("robot", 500.0)])
def test_place_and_velocity_err_by_what_they_say(who: str, rate: float) -> None:
    path = path_of(who, rate)
    assert path is not None and path.noise == pytest.approx(NOISE, rel=0.15)
    off = []
    for when in np.random.default_rng(2).uniform(1.0, 11.0, 150):
        motion = path.motion(float(when))
        assert motion is not None
        (place, velocity, _), covariance = motion
        angle = TURN * when
        truth = [[0.5 + SWING * np.cos(angle), 0.5 + 0.5 * SWING * np.sin(angle)],
                 [-SWING * TURN * np.sin(angle), 0.5 * SWING * TURN * np.cos(angle)]]  # fmt: skip
        std = np.sqrt(covariance[:, [0, 1], [0, 1]]).T
        assert std[1].max() < 0.06
        off.append((np.array([place, velocity]) - truth) / std)
    assert 0.3 < np.sqrt(np.mean(np.square(off))) < 1.5


def test_a_mallet_that_too_few_samples_see_has_no_path_and_a_hole_no_motion() -> None:
    t, place = swinging(500.0)
    empty = Recording("none", META)
    assert robot_path(empty) is None and opponent_path(empty) is None
    assert path_of("robot", 2.0) is None
    kept = (t < 5.0) | (t > 5.2)
    path = MalletPath(t[kept], place[kept], NOISE, (1e3, 1e3), (np.zeros(0), np.zeros(0)))
    assert path.motion(5.1) is None and path.motion(4.0) is not None


def bang_bang(lag: float, seconds: float = 12.0) -> Recording:
    """A mallet that goes to and fro along x with 60 m/s^2, turned at the times of its plans and `lag` [s] later."""
    rate, begins = 500.0, np.arange(0.05, seconds - 0.2, 0.1)
    half = 0.02 + 0.01 * np.random.default_rng(3).random(len(begins))
    switches = np.concatenate(
        [[begin, begin + one, begin + 2.0 * one] for begin, one in zip(begins, half, strict=True)]
    )
    pushes = np.tile([60.0, -60.0, 0.0], len(begins)) * np.repeat(np.resize([1.0, -1.0], len(begins)), 3)
    t = np.arange(int(seconds * rate)) / rate
    x = np.full(len(t), 0.5)
    for switch, change in zip(switches + lag, np.diff(pushes, prepend=0.0), strict=True):
        x += 0.5 * change * np.maximum(t - switch, 0.0) ** 2
    place = np.stack([x, np.full(len(t), 0.5)], axis=1) + np.random.default_rng(1).normal(0.0, 1e-5, (len(t), 2))
    zero = np.zeros(len(begins))
    plans = {"t": begins, "t_x1": half, "t_x2": 2.0 * half, "t_y1": zero, "t_y2": zero}
    nobody = np.full(len(t), np.nan)
    frames = Stream({"t": t, "puck_x": nobody, "puck_y": nobody})
    mallet = Stream({"t": t, "mallet_x": place[:, 0], "mallet_y": place[:, 1]})
    return Recording("one", META, frames, mallet, Stream(plans))


@pytest.mark.parametrize("lag", [0.0, 0.0029, 0.0051, 0.0103, 0.0136, 0.0192])
def test_switches_act_when_they_do(lag: float) -> None:
    recording = bang_bang(lag)
    path, plans = robot_path(recording), recording.commands
    assert path is not None and plans is not None and len(path.switches[0])
    assert path.switches[0][0] - plans.t[0] == pytest.approx(lag, abs=3e-4)


def test_a_mallet_s_velocity_is_known_right_after_a_switch() -> None:
    """A contact there is frequent: 2 ms after the mallet was turned, 5.1 ms after it was to turn."""
    recording = bang_bang(0.0051)
    path, plans = robot_path(recording), recording.commands
    assert path is not None and plans is not None
    for begin, half, sign in zip(plans.t, plans["t_x1"], np.resize([1.0, -1.0], plans.rows), strict=True):
        motion = path.motion_at_contact(float(begin + half + 0.0071))
        assert motion is not None
        assert motion[0][0] == pytest.approx(sign * 60.0 * (half - 0.002), abs=0.03)
