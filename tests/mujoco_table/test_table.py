"""What MuJoCo's table does, against sums done by hand: what its cases claim to hold, and how nearly."""

from __future__ import annotations

import json
from math import exp, hypot
from pathlib import Path

import numpy as np
import pytest

from sim2real.study.independent_table.recorder.camera import Camera, look_up
from tests.mujoco_table.cases import CASES
from tests.mujoco_table.launches import fly, make_recording
from tests.mujoco_table.model import Settings
from tests.sim2real.study.independent_table.test_recordings import columns

ICE = Settings(friction=0.0, spin_decay=0.0)


def test_friction_brakes_all_headings_alike_and_spin_does_not_matter():
    for vx, vy, spin in ((0.6, 0.0, 0.0), (0.36, 0.48, 0.0), (0.0, -0.6, 25.0)):
        rows = fly(Settings(), (0.5, 0.6, vx, vy), 0.6, spin)
        assert hypot(*rows[-1, 2:4]) == pytest.approx(0.6 - 0.125 * (len(rows) - 1) * 1e-4, abs=1e-5)
        assert rows[-1, 5] == pytest.approx(spin * exp(-0.3 * 0.6), rel=1e-3, abs=1e-6)


def test_tilt_and_damping():
    moved = fly(Settings(friction=0.0, tilt_x=0.02, tilt_y=-0.012, damping=0.1), (0.5, 0.5, 0.6, 0.3), 1.0001)[-1]
    lost = 1.0 - exp(-0.1)
    assert moved[2:4] == pytest.approx(
        (0.6 * exp(-0.1) + 0.2 * lost, 0.3 * exp(-0.1) - 0.12 * lost), abs=1.2e-4
    )  # 1e-5 g of friction


@pytest.mark.parametrize("speed", [0.3, 1.0, 3.0])
def test_without_friction_a_wall_keeps_the_tangent_and_a_constant_share_of_the_normal(speed: float):
    after = fly(ICE, (1.0, 0.06, 0.5 * speed, -speed), 0.2 / speed)[-1, 2:4]
    assert after == pytest.approx((0.5 * speed, 0.8 * speed), rel=0.015)


def test_wall_friction_slips_or_grips_and_spins():
    law = Settings(friction=0.0, spin_decay=0.0, wall_mu=0.15)
    slips = fly(law, (0.5, 0.1, 2.0, -1.0), 0.15)[-1]
    assert slips[2] == pytest.approx(2.0 - 0.15 * 1.8, abs=0.01)
    assert slips[3] == pytest.approx(0.8, rel=0.03)
    assert slips[5] * 0.5 * law.puck_radius == pytest.approx(slips[2] - 2.0, rel=0.01)  # kappa r w is the impulse
    grips = fly(law, (0.5, 0.1, 0.5, -1.0), 0.15)[-1]
    assert grips[2] == pytest.approx(0.5 - 0.5 / 3.0, rel=0.07)
    assert grips[3] == pytest.approx(0.8, rel=0.06)


def test_the_mouth_of_a_goal_is_open_and_ends_the_flight():
    rows = fly(ICE, (0.3, 0.5, -1.0, 0.0), 1.0)
    assert rows[-1, 0] == pytest.approx(0.0, abs=2e-4)
    beside = fly(ICE, (0.3, 0.2, -1.0, 0.0), 0.5)
    assert beside[-1, 2] == pytest.approx(0.8, rel=0.02)
    assert len(beside) == 5000  # a hit is no rest


def test_a_recording_has_the_format_and_the_noise_of_its_camera(tmp_path: Path):
    settings, truth = CASES["tilt"]
    scene = make_recording(tmp_path, settings, 1, 6.0, Camera(noise=0.0005, jitter=0.0))
    assert set(truth) == {"table_tilt", "tangential_restitution"}
    assert sorted(path.name for path in tmp_path.iterdir()) == ["frames.csv", "meta.json"]
    assert json.loads((tmp_path / "meta.json").read_text())["table"]["length_m"] == 2.0
    frames = columns(tmp_path / "frames.csv")
    off = frames["puck_x"] - look_up(frames["t"], scene.puck)[:, 0]
    assert np.nanstd(off) == pytest.approx(0.0005, rel=0.15)
    assert np.isfinite(off).sum() > 400
