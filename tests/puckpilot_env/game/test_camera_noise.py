"""What spoils camera frames, and how much: white noise, the smooth error, the beam's shadow, lost and held frames."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from scipy import stats

from puckpilot_env import Tables
from puckpilot_env.game import sensing, state
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import distort
from tests.puckpilot_env.game.hand import FRICTIONLESS, LENGTH, NO_CAMERA_NOISE, WIDTH, put_puck, seen, staying

LAGS = (0, 1, 2, 5, 11)
COUNT = 4000
BEAM = 0.04  # m; a mallet at home has its middle 0.25 m from its own end


def watch(x: float, y: float, *, seen_by: int = 0, vx: float = 0.0, period: float = 0.1, **values: float) -> Tables:
    """Tables whose camera has watched the puck, at (x, y) as `seen_by` sees it, with nothing amiss but `values`."""
    clean = {**NO_CAMERA_NOISE, **FRICTIONLESS, "beam_width": BEAM, **values}
    tables = Tables("match-sensors-v0", COUNT, seed=6, period=period, parameters=clean)
    put_puck(tables, x, y, vx, player=seen_by)
    for _ in range(round(0.3 / period)):
        tables.step(staying(tables))
    return tables


def spread(tables: Tables, player: int, name: str) -> float:
    return float(np.std([seen(tables, player, f"{name.format(lag)}") for lag in LAGS]))


@pytest.mark.parametrize("player", [0, 1])
@pytest.mark.parametrize(
    "from_mallet, sigma",
    [(0.0212, 0.0006), (0.035, 0.0006), (-0.035, 0.0006), (0.0507, 0.0006), (0.0511, 0.0002), (0.4, 0.0002)],
)
def test_white_noise(player, from_mallet, sigma):
    """0.6 mm from the edge of either beam to where the puck is clear of it (0.02 m + 0.0309 m), 0.2 mm beyond; of the
    mallets always 0.2 mm."""
    tables = watch(0.25 + from_mallet, 0.2, seen_by=player, camera_noise=0.0002, beam_noise=0.0006)
    for axis in "xy":
        for k in range(2):
            assert spread(tables, k, f"puck_{{}}_{axis}") == pytest.approx(sigma, rel=0.03)
            assert spread(tables, k, f"opponent_{{}}_{axis}") == pytest.approx(0.0002, rel=0.03)


def test_white_noise_is_white_and_normal():
    tables = watch(0.7, 0.3, camera_noise=0.0002)
    names = [f"{what}_{lag}_{axis}" for what in ("puck", "opponent") for lag in LAGS for axis in "xy"]
    names += [f"opponent_{lag}_{axis}" for lag in LAGS for axis in "xy"]  # as player 1 sees it
    noise = np.array([seen(tables, int(i >= 4 * len(LAGS)), name) for i, name in enumerate(names)])
    noise -= np.median(noise, axis=1, keepdims=True)
    assert np.abs(noise.mean(axis=1)).max() < 5 * 0.0002 / np.sqrt(COUNT)
    for row in noise[::5]:
        assert stats.kstest(row / 0.0002, "norm").pvalue > 1e-4
    assert np.abs(np.corrcoef(noise) - np.eye(len(noise))).max() < 5 / np.sqrt(COUNT)


@pytest.mark.parametrize("player", [0, 1])
@pytest.mark.parametrize("from_mallet, hidden", [(0.0, True), (0.0195, True), (-0.0195, True), (0.0205, False)])
def test_hidden_under_either_beam(player, from_mallet, hidden):
    """The last place seen stays, the one from before the puck got there; the mallets are seen all the same."""
    tables = watch(0.25 + from_mallet, 0.2, seen_by=player)
    for lag in LAGS:
        for k, x in ((player, 0.25 + from_mallet), (1 - player, 1.75 - from_mallet)):
            assert (seen(tables, k, f"seen_{lag}") == (0 if hidden else 1)).all()
            place = seen(tables, k, f"puck_{lag}_x")
            assert (np.abs(place - x) < 1e-6).all() != hidden
            np.testing.assert_allclose(seen(tables, k, f"opponent_{lag}_x"), 1.75, atol=1e-6)


def loudness(x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """Mean square of five terms, orthonormal over the table by Legendre's polynomials; 1 on average over the table,
    more at its ends, where no puck's middle gets."""
    u, w = 2 * x / LENGTH - 1, 2 * y / WIDTH - 1
    return (1 + 3 * u**2 + 3 * w**2 + 9 * u**2 * w**2 + 5 * (1.5 * u**2 - 0.5) ** 2) / 5


def test_smooth_error_in_play():
    """Fixed for an episode at a place, 1 mm rms over the table, the same for all frames and from both seats."""
    rng = np.random.default_rng(2)
    tables = Tables("match-sensors-v0", COUNT, seed=6, parameters={**NO_CAMERA_NOISE, "camera_error": 0.001})
    x, y = rng.uniform(0, LENGTH, COUNT), rng.uniform(0, WIDTH, COUNT)
    off = (np.abs(x - 0.25) > 0.09) & (np.abs(x - 1.75) > 0.09) & (np.abs(x - 1) < 0.97) & (np.abs(y - 0.5) < 0.47)
    put_puck(tables, x, y)
    for _ in range(3):
        tables.step(staying(tables))
    errors = np.array([
        [seen(tables, 0, f"puck_{lag}_x") - x, seen(tables, 0, f"puck_{lag}_y") - y,
         seen(tables, 1, f"puck_{lag}_x") - LENGTH + x, seen(tables, 1, f"puck_{lag}_y") - WIDTH + y] for lag in LAGS
    ])[:, :, off]  # fmt: skip
    assert np.ptp(errors, axis=0).max() < 3e-7  # float32
    np.testing.assert_allclose(errors[:, 2:], -errors[:, :2], atol=3e-7)
    squares = errors[0, 0] ** 2 + errors[0, 1] ** 2
    assert np.sqrt(np.mean(squares / loudness(x[off], y[off]))) == pytest.approx(0.001, rel=0.04)
    assert np.abs(np.corrcoef(errors[0, :2]) - np.eye(2)).max() < 5 / np.sqrt(off.sum())


def measured(table: Any, p: Any, x: float, y: float) -> list[float]:
    place = np.zeros(1, state.PLACE)
    sensing.measure(table, p, x, y, 0.0, place[0])
    return place[0].tolist()


def test_smooth_error_over_the_table():
    """A camera's error is a quadratic surface: third differences vanish, and 1 cm changes it little. Its mean square
    over the table is `camera_error` squared on average over cameras, and camera_error scales it."""
    tables = Tables("match-sensors-v0", 100, seed=6, parameters={**NO_CAMERA_NOISE, "camera_error": 0.002})
    p = tables.params[0]
    xs, ys = (np.arange(20) + 0.5) / 20 * LENGTH, (np.arange(10) + 0.5) / 10 * WIDTH
    squares = []
    for table in tables.states:
        seen_at = np.array([[measured(table, p, x, y) for y in ys] for x in xs])
        error = seen_at - np.stack(np.meshgrid(xs, ys, indexing="ij"), axis=2)
        for axis in range(2):
            assert np.abs(np.diff(error, 3, axis=axis)).max() < 1e-14
        assert np.abs(np.diff(error, axis=0)).max() < 0.002  # over 10 cm
        squares.append(np.mean(np.sum(error**2, axis=2)))
    assert np.sqrt(np.mean(squares)) == pytest.approx(0.002, rel=0.12)  # of 100 cameras with ten terms each


@pytest.mark.parametrize("share", [0.01, 0.2])
@pytest.mark.parametrize("period", [1 / 120, 0.1])
def test_dropped_frames(share, period):
    """Without a position as often as said, whichever the frame; marked so; the opponent is measured all the same."""
    tables = watch(0.7, 0.3, period=period, dropped_frames=share, camera_noise=0.0002)
    lost = np.array([seen(tables, 0, f"seen_{lag}") == 0 for lag in LAGS])
    assert np.abs(lost.mean(axis=1) - share).max() < 4.5 * np.sqrt(share / COUNT)
    repeated = seen(tables, 0, "puck_0_x") == seen(tables, 0, "puck_1_x")
    assert (repeated == lost[0]).mean() > 0.999  # float32 makes one or another pair equal
    assert (seen(tables, 0, "opponent_0_x") == seen(tables, 0, "opponent_1_x")).mean() < 0.002
    both = (lost[0] & lost[1]).mean()
    assert both == pytest.approx(share**2, abs=5 * share / np.sqrt(COUNT))  # each frame by itself
    assert all((seen(tables, 1, f"seen_{lag}") == ~gone).all() for lag, gone in zip(LAGS, lost, strict=True))


@pytest.mark.parametrize("share", [0.02, 0.2])
def test_held_frames(share):
    """Repeat the frame before them in everything, as often as said, and look like any other."""
    tables = watch(0.7, 0.3, vx=0.25, period=1 / 120, held_frames=share, camera_noise=0.0002)
    for k in range(2):
        same = [
            seen(tables, k, f"{name}_0_{axis}") == seen(tables, k, f"{name}_1_{axis}")
            for name in ("puck", "opponent")
            for axis in "xy"
        ]
        assert np.all(same, axis=0).mean() == pytest.approx(share, abs=4.5 * np.sqrt(share / COUNT))
        for lag in LAGS:
            assert (seen(tables, k, f"seen_{lag}") == 1).all()


def test_held_frames_are_one_frame_older():
    """At 0.1 s a step the frames before lags 2 and 5 are not taken; a held one shows the puck there all the same."""
    tables = watch(0.7, 0.3, vx=0.25, period=0.1, held_frames=0.2)
    for k in range(2):
        apart = np.abs(seen(tables, k, "puck_2_x") - seen(tables, k, "puck_5_x")) * 120 / 0.25  # in frames
        np.testing.assert_allclose(apart, apart.round(), atol=1e-3)
        shares = [np.mean(apart.round() == frames) for frames in (2, 3, 4)]
        np.testing.assert_allclose(shares, [0.16, 0.68, 0.16], atol=0.03)


@pytest.mark.parametrize("player", [0, 1])
def test_a_stretched_and_sheared_map(player):
    """Both seats share one camera, whose map is about the robot's right-hand corner: the reference's `distort`."""
    law = Law(camera_scale_x=0.012, camera_scale_y=-0.02, camera_shear=0.008)
    values = {name: getattr(law, name) for name in ("camera_scale_x", "camera_scale_y", "camera_shear")}
    tables = watch(0.7, 0.3, seen_by=player, camera_error=0.0, **values)
    for k in range(2):
        place = np.array([[0.7, 0.3]]) if k == player else np.array([[LENGTH - 0.7, WIDTH - 0.3]])
        true = place if k == 0 else np.array([LENGTH, WIDTH]) - place  # as the camera over the table has it
        shown = distort(law, true)[0]
        x, y = shown if k == 0 else np.array([LENGTH, WIDTH]) - shown
        np.testing.assert_allclose(seen(tables, k, "puck_0_x"), x, atol=1e-6)
        np.testing.assert_allclose(seen(tables, k, "puck_0_y"), y, atol=1e-6)


def test_a_map_without_error_leaves_the_smooth_error_as_drawn():
    plain, given = (
        Tables("match-sensors-v0", 50, seed=6, parameters=values)
        for values in ({}, {"camera_scale_x": 0.0, "camera_scale_y": 0.0, "camera_shear": 0.0})
    )
    stretched = Tables("match-sensors-v0", 50, seed=6, parameters={"camera_scale_x": 0.01})
    for name in ("error_x", "error_y"):
        assert np.array_equal(plain.states["camera"][name], given.states["camera"][name])
    apart = stretched.states["camera"]["error_x"] - plain.states["camera"]["error_x"]
    assert np.abs(apart[:, 1]).min() > 0.005 and np.abs(apart[:, 2:]).max() < 1e-12
