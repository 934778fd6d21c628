"""Belt compliance and backlash of the reference, and recordings of a mallet alone."""

from __future__ import annotations

import json
from math import pi, sin

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.linalg import expm
from scipy.optimize import brentq

from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.camera import look_up
from sim2real.study.independent_table.recorder.record import make_recording
from tests.sim2real.study.independent_table.test_recordings import columns

X = (5.2955e-6, 0.008449, 0.05315)  # C5, C6, C7 of the x axis
HALF = 0.017653  # of the pulley's radius
PLAN = (9.0, 0.0, 0.1, 0.0, 0.17, 0.0)
INTERVALS = ((9.0, 0.1), (-9.0, 0.07), (0.0, 0.08))


def test_the_belt_follows_its_motor_as_the_matrix_exponential_says():
    law = Law(belt_hz=11.0, belt_zeta=0.15)
    trace = run(law, mallets=[(0.3, 0.5)], plans=[PLAN], duration=0.25)
    w, c = 2.0 * pi * 11.0, 2.0 * 0.15 * 2.0 * pi * 11.0
    c5, c6, c7 = X
    matrix = np.zeros((6, 6))  # motor p, p', p'', mallet m, m', volts
    matrix[0, 1] = matrix[1, 2] = matrix[3, 4] = 1.0
    matrix[2, [1, 2, 5]] = -c7 / c5, -c6 / c5, HALF / c5
    matrix[4, [0, 1, 3, 4]] = w * w, c, -w * w, -c
    state = np.array([0.3, 0, 0, 0.3, 0])
    for volts, seconds in INTERVALS:
        state = (expm(matrix * seconds) @ np.array([*state, volts]))[:5]
    assert trace.mallets[0, -1, 6] == pytest.approx(state[0], abs=1e-10)
    assert trace.mallets[0, -1, [0, 1]] == pytest.approx(state[3:], abs=1e-7)
    assert abs(state[3] - state[0]) > 1e-3
    begun = run(law, mallets=[(0.3, 0.5)], plans=[PLAN], duration=0.1)
    rest = (-9.0, 0.0, 0.07, 0.0, 0.07, 0.0)
    ended = run(law, mallets=begun.end_mallets, plans=[rest], duration=0.15)
    assert ended.end_mallets == pytest.approx(trace.end_mallets, abs=1e-9)


def test_a_stiff_belt_is_no_belt():
    stiff = run(Law(belt_hz=400.0, belt_zeta=1.0), mallets=[(0.3, 0.5)], plans=[PLAN], duration=0.4)
    plain = run(Law(), mallets=[(0.3, 0.5)], plans=[PLAN], duration=0.4)
    assert stiff.mallets[0, :, 0] == pytest.approx(plain.mallets[0, :, 0], abs=1e-4)


def test_a_gap_is_lost_at_the_start_and_at_each_reversal():
    plan = (6.0, 0.0, 0.2, 0.0, 0.5, 0.0)  # there, and back beyond
    trace = run(Law(backlash=0.002), mallets=[(0.3, 0.5)], plans=[plan], duration=0.5)
    motor, mallet = trace.mallets[0, :, 6], trace.mallets[0, :, 0]
    plain = run(Law(), mallets=[(0.3, 0.5)], plans=[plan], duration=0.5)
    assert motor == pytest.approx(plain.mallets[0, :, 0], abs=1e-12)
    top = int(np.argmax(motor))
    assert mallet[20:top] == pytest.approx(motor[20:top] - 0.001, abs=1e-9)
    assert mallet.max() == pytest.approx(motor.max() - 0.001, abs=1e-6)  # the highest point lies between two samples
    still = (motor > mallet.max() - 0.001) & (np.arange(len(motor)) > top)
    assert still.sum() > 3
    assert np.ptp(mallet[still]) < 1e-7
    assert (trace.mallets[0, still, 1][1:] == 0.0).all()
    assert mallet[-1] == pytest.approx(motor[-1] + 0.001, abs=1e-9)


def test_belt_and_gap_together_are_refused():
    with pytest.raises(ValueError, match="belt_hz and backlash"):
        run(Law(belt_hz=10.0, backlash=0.001), mallets=[(0.3, 0.5)])


def test_losses_by_place_and_by_speed():
    c5, c6, c7 = X

    def motion(t, s):
        return s[1], s[2], (HALF * 6.0 - c6 * s[2] - c7 * s[1] * (1.0 + 0.3 * sin(2 * pi * s[0] / 0.25))) / c5

    exact = solve_ivp(motion, (0.0, 0.3), (0.3, 0.0, 0.0), method="LSODA", rtol=1e-11, atol=1e-12).y[0, -1]
    steady = (6.0, 0.0, 9.0, 0.0, 9.0, 0.0)
    rough = run(Law(rough=0.3, rough_length=0.25), mallets=[(0.3, 0.5)], plans=[steady], duration=0.3)
    assert rough.mallets[0, -1, 0] == pytest.approx(exact, abs=1e-8)
    fast = run(Law(cubic_loss=0.2), mallets=[(0.3, 0.5)], plans=[steady], duration=3.0, dt=1e-4).mallets[0, -1, 1]
    assert fast == pytest.approx(brentq(lambda v: c7 * v * (1.0 + 0.2 * v * v) - HALF * 6.0, 0.0, 3.0), abs=1e-7)


def test_a_mallet_alone_obeys_its_commands(tmp_path):
    make_recording(tmp_path, Law(), "gantry", 4, 6.0, encoder_noise=0.0)
    assert (tmp_path / "frames.csv").read_text() == "t,puck_x,puck_y,opponent_x,opponent_y\n"
    assert not (tmp_path / "drive.csv").exists()
    commands, mallet = columns(tmp_path / "commands.csv"), columns(tmp_path / "mallet.csv")
    assert len(commands["t"]) == 60
    assert 10 <= len(set(commands["x_f"])) <= 30
    settled = commands["t"] + np.maximum(commands["t_x2"], commands["t_y2"]) + 0.01 < commands["t"] + 0.1
    at = np.searchsorted(mallet["t"], commands["t"][settled] + 0.099) - 1
    assert settled.sum() > 3
    assert mallet["mallet_x"][at] == pytest.approx(commands["x_f"][settled], abs=1e-4)
    assert mallet["mallet_y"][at] == pytest.approx(commands["y_f"][settled], abs=1e-4)


def test_a_log_of_the_motors_holds_what_moved_the_mallet(tmp_path):
    law = Law(deadband=0.4)
    scene = make_recording(tmp_path, law, "drive", 4, 3.0, encoder_noise=0.0)
    assert not (tmp_path / "commands.csv").exists()
    assert json.loads((tmp_path / "meta.json").read_text())["gantry"] == {"pulley_radius_m": 0.035306, "supply_V": 24.0}
    drive, mallet = columns(tmp_path / "drive.csv"), columns(tmp_path / "mallet.csv")
    assert np.diff(drive["t"]) == pytest.approx(1e-3, abs=1e-9)
    volts = 24.0 * (drive["pwm_left"] - drive["pwm_right"]), -24.0 * (drive["pwm_left"] + drive["pwm_right"])
    c5, c6, c7 = X
    matrix = np.array([[0, 1, 0, 0], [0, 0, 1, 0], [0, -c7 / c5, -c6 / c5, HALF / c5], [0, 0, 0, 0.0]])
    step = expm(matrix * 1e-3)
    state, path = np.array([scene.mallets[0, 0, 0], 0.0, 0.0]), []
    for v in volts[0]:
        path.append(state[0])
        state = (step @ np.array([*state, np.sign(v) * max(0.0, abs(v) - 0.4)]))[:3]
    assert mallet["mallet_x"] == pytest.approx(np.array(path)[::2], abs=2e-4)  # the log has five digits
    assert abs(mallet["expected_x"] - mallet["mallet_x"]).max() > 1e-3
    true = make_recording(tmp_path, Law(), "drive", 4, 3.0, encoder_noise=0.0)
    mallet = columns(tmp_path / "mallet.csv")
    assert mallet["expected_y"] == pytest.approx(mallet["mallet_y"], abs=1e-5)
    assert true.expected == pytest.approx(true.mallets[0], abs=1e-9)


def test_the_encoders_clock_runs_by_itself(tmp_path):
    scene = make_recording(tmp_path, Law(encoder_clock=2e-3), "gantry", 4, 3.0, encoder_noise=0.0)
    mallet, commands = columns(tmp_path / "mallet.csv"), columns(tmp_path / "commands.csv")
    assert mallet["mallet_x"] == pytest.approx(look_up(mallet["t"] / 1.002, scene.mallets[0])[:, 0], abs=2e-5)
    assert commands["t"] == pytest.approx(np.arange(30) * 0.1, abs=1e-9)
