"""Safe stops at the twin: each way out ends with the mallet at rest, and play goes on after `clear`."""

from __future__ import annotations

import weakref

import numpy as np
import pytest

pytest.importorskip("unicorn", reason="unicorn is not installed: the program cannot be emulated")

import puckpilot_env  # noqa: F401 - registers the ids
from sim2real.table.board_config import SILENCE
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.robot_seat import RobotSeat
from tests.sim2real.table.seats import STAY, twin_of


def test_a_motor_never_gets_more_than_15_volts(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    for k in range(10):
        seat.step(np.array([0.1 + 0.8 * (k % 2), 0.1 + 0.8 * (k % 2), 10.0, 10.0], np.float32))
    board = twin_of(seat).board
    assert board is not None and 9.0 < board.most_volts <= 15.0


@pytest.mark.parametrize("target", [(0.9, 0.9, 3.0, 3.0), (0.9, 0.5, 10.0, 10.0), (0.6, 0.94, 10.0, 10.0)])
def test_a_cable_that_is_cut_has_the_mallet_braked_to_rest(seat: RobotSeat, target: tuple) -> None:
    """From the moment on at which the board notices, by all that its motors may give, inside the area."""
    seat.reset(seed=1)
    seat.step(np.array(target, np.float32))
    twin = twin_of(seat)
    board, cut = twin.board, twin.now()
    assert board is not None and max(map(abs, board.machine.motors.duties)) > 0.0
    board.cut = True
    with pytest.raises(TableFaultError, match="port is lost"):
        seat.step(np.array(target, np.float32))
    silent = cut + 1e-3 * SILENCE
    board.run(silent)
    *_, vx, vy = twin.plant.mallet(0)
    needs = (abs(vx) / 2.09 + abs(vy) / 5.94) / 30.0  # s: by R/(2 C6) of x and y, and 15 V at both motors
    board.run(silent + needs + 0.008)
    assert np.abs(twin.plant.mallet(0)[2:]).max() < 0.05
    board.run(silent + needs + 0.03)
    assert board.machine.motors.duties == (0.0, 0.0) and 0.0 < board.most_volts <= 15.0
    board.run(cut + 0.5)
    x, y, vx, vy = twin.plant.mallet(0)
    assert max(abs(vx), abs(vy)) < 0.02 and x < 0.9495 + 1e-4 and y < 0.9495 + 1e-4


def test_a_camera_that_is_unplugged_stops_the_mallet(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    twin = twin_of(seat)
    twin.camera.unplugged = True
    board = twin.board
    assert board is not None
    with pytest.raises(TableFaultError, match="no frame for"):
        seat.step(np.array([0.9, 0.9, 3.0, 3.0], np.float32))
    board.run(board.now() + 0.05)
    assert np.abs(twin.plant.mallet(0)[2:]).max() < 0.02
    assert board.machine.motors.duties == (0.0, 0.0)


@pytest.mark.parametrize("seconds", [0.02, 0.3])
def test_a_player_that_takes_too_long_is_reported_as_such(seat: RobotSeat, seconds: float) -> None:
    """And not that the table or the cable is to be seen to."""
    seat.reset(seed=1)
    twin = twin_of(seat)
    twin.pass_time(twin.now() + seconds)
    with pytest.raises(
        TableFaultError, match=rf"not served for {1e3 * seconds:.0f}.* ms.*player or this computer"
    ) as why:
        seat.step(STAY)
    assert why.value.cause == Cause.OVERRUN
    seat.clear()
    seat.step(STAY)


def test_a_board_that_is_reset_ends_the_game_with_motors_off(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    seat.step(np.array([0.9, 0.9, 3.0, 3.0], np.float32))
    board = twin_of(seat).board
    assert board is not None
    board.machine.reset("watchdog")
    with pytest.raises(TableFaultError, match=r"BOOT and not ARMED; clear to arm it again"):
        seat.step(np.array([0.9, 0.9, 3.0, 3.0], np.float32))
    assert board.machine.motors.duties == (0.0, 0.0)


@pytest.mark.parametrize("ms", [0.5, 1.5, 2.5, 3.0, 3.5, 4.5, 6.0])
def test_a_board_that_was_reset_just_before_a_plan_is_said_to_have_been(seat: RobotSeat, ms: float) -> None:
    """Whatever is noticed first: its refusal, that it is greeted again, that its clock is unknown, its state."""
    seat.reset(seed=1)
    for _ in range(2):
        seat.step(np.array([0.9, 0.9, 6.0, 6.0], np.float32))
    twin = twin_of(seat)
    assert twin.board is not None
    twin.board.machine.reset("watchdog")
    with pytest.raises(TableFaultError) as raised:
        twin.wait(twin.now() + 1e-3 * ms)
        seat.step(np.array([0.3, 0.3, 6.0, 6.0], np.float32))
    assert raised.value.cause in (Cause.BOARD_NOT_ARMED, Cause.BOARD_SILENT), raised.value
    twin.board.run(twin.now() + 0.05)  # it brakes by itself meanwhile
    assert twin.board.machine.motors.duties == (0.0, 0.0)


def test_a_mallet_that_is_held_fast_ends_the_game_with_motors_off(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    twin, fast = twin_of(seat), np.array([0.9, 0.9, 10.0, 10.0], np.float32)
    twin.plant.drive = lambda first, second: None  # pyright: ignore[reportAttributeAccessIssue] - the belts are off
    with pytest.raises(TableFaultError, match=r"the board stopped the motors: (OFF_PATH|ENCODER_FROZEN)"):
        for _ in range(10):
            seat.step(fast)
    assert twin.board is not None and twin.board.machine.motors.duties == (0.0, 0.0)


@pytest.mark.parametrize("hang", [0.15, 0.25, 1.0])
def test_a_policy_that_hangs_leaves_the_mallet_at_its_target(seat: RobotSeat, hang: float) -> None:
    """And play goes on afterwards, from wherever the mallet is."""
    seat.reset(seed=1)
    target = np.array([0.9, 0.9, 10.0, 10.0], np.float32)
    seat.step(target)
    twin = twin_of(seat)
    twin.wait(twin.now() + hang)
    assert twin.board is not None
    if hang == 1.0:
        assert twin.plant.mallet(0) == pytest.approx((0.9, 0.9, 0.0, 0.0), abs=0.002)
        assert twin.board.machine.motors.duties == (0.0, 0.0)
    for _ in range(10):
        seat.step(STAY)
    assert twin.plant.mallet(0)[:2] == pytest.approx(STAY[:2], abs=0.002)


def test_after_a_plan_that_was_lost_on_the_line_the_next_begins_where_the_mallet_is(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    board = twin_of(seat).board
    assert board is not None and seat.loop is not None
    write = board.write
    board.write = lambda data: write(data) if len(data) < 40 else None  # trajectories are lost, pings are not
    seat.step(np.array([0.9, 0.9, 10.0, 10.0], np.float32))
    board.write = write
    infos = [seat.step(np.array([0.3, 0.3, 10.0, 10.0], np.float32))[-1] for _ in range(5)]
    assert seat.loop.missed == 1 and max(info["off_path"] for info in infos) < 0.002
    assert twin_of(seat).plant.mallet(0)[:2] == pytest.approx((0.3, 0.3), abs=0.002)


def test_a_refused_plan_ends_the_game(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    assert seat.loop is not None
    seat.loop._driver.stand(0.7, 0.3, twin_of(seat).now())  # where the mallet is not
    with pytest.raises(TableFaultError, match="the board refused a traj, OFF_START; clear"):
        seat.step(STAY)
    seat.reset()
    seat.step(STAY)


def test_after_a_fault_a_new_episode_begins_or_the_game_goes_on_where_the_mallet_stopped(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    twin = twin_of(seat)
    for _ in range(3):
        *_, info = seat.step(np.array([0.9, 0.9, 5.0, 5.0], np.float32))
    twin.camera.unplugged = True
    with pytest.raises(TableFaultError, match=r"no frame for 2. ms; check the camera and clear"):
        seat.step(STAY)
    with pytest.raises(TableFaultError, match="no frame for"):  # it is still unplugged
        seat.clear()
    twin.camera.unplugged = False
    observation, after = seat.clear()
    assert np.isfinite(observation).all() and after["play_time"] == pytest.approx(info["play_time"], abs=0.11)
    assert after["new_point"] and twin.plant.mallet(0)[:2] == pytest.approx((0.25, 0.5), abs=0.002)
    seat.step(STAY)
    assert seat.reset()[1]["play_time"] == 0.0
    seat.step(STAY)


def test_a_board_that_was_reset_is_homed_again_by_hand_before_the_game_goes_on(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    for _ in range(3):
        seat.step(np.array([0.9, 0.9, 5.0, 5.0], np.float32))
    twin = twin_of(seat)
    assert twin.board is not None
    twin.board.machine.reset("watchdog")
    with pytest.raises(TableFaultError):
        seat.step(STAY)
    seat.clear()
    seat.step(STAY)
    assert twin.plant.mallet(0)[:2] == pytest.approx(twin.place(), abs=0.001)


def test_closing_stops_the_mallet(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    seat.step(np.array([0.9, 0.9, 3.0, 3.0], np.float32))
    board, plant = twin_of(seat).board, twin_of(seat).plant
    seat.close()
    assert board is not None
    assert board.machine.motors.duties == (0.0, 0.0)
    plant.advance(plant.time + 0.05)  # nothing drives it any more
    assert np.abs(plant.mallet(0)[2:]).max() < 0.02
    with pytest.raises(ValueError, match="call reset"):
        seat.step(STAY)


def test_ctrl_c_in_the_midst_of_the_emulator_ends_with_motors_off(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    board = twin_of(seat).board
    assert board is not None
    encoder, interrupted = board.machine.encoders[0], []
    angle = encoder.angle

    def interrupt(now: float) -> float:
        if not interrupted and now > begin + 60_000:
            interrupted.append(now)
            assert board.machine.motors.duties != (0.0, 0.0)
            raise KeyboardInterrupt
        return angle(now)

    begin, encoder.angle = board.machine.now, interrupt
    with pytest.raises(KeyboardInterrupt):
        seat.step(np.array([0.9, 0.9, 8.0, 8.0], np.float32))
    assert interrupted and board.machine.motors.duties == (0.0, 0.0)


@pytest.mark.parametrize("pause", [0.3, 0.95, 1.0, 3.0])
def test_between_episodes_a_player_may_take_its_time(seat: RobotSeat, pause: float) -> None:
    """Longer than a session that nobody serves is believed, and about as long."""
    seat.reset(seed=1)
    seat.game.rule["match_time"] = 0.05
    _, _, terminated, truncated, _ = seat.step(STAY)
    assert terminated or truncated
    twin = twin_of(seat)
    assert twin.board is not None
    twin.board.run(twin.now() + pause)  # nobody serves the board
    seat.reset()
    assert np.isfinite(seat.step(STAY)[0]).all()


@pytest.mark.parametrize("pause", [0.95, 1.0, 3.0])
def test_a_person_may_take_their_time_to_mend_and_clear(seat: RobotSeat, pause: float) -> None:
    seat.reset(seed=1)
    seat.step(STAY)
    twin = twin_of(seat)
    twin.camera.unplugged = True
    with pytest.raises(TableFaultError, match="no frame for"):
        seat.step(STAY)
    twin.camera.unplugged = False
    assert twin.board is not None
    twin.board.run(twin.now() + pause)  # nobody serves the board
    seat.clear()
    assert np.isfinite(seat.step(STAY)[0]).all()


def test_after_a_refused_action_clear_plays_on_and_after_the_end_it_does_not(seat: RobotSeat) -> None:
    seat.reset(seed=1)
    with pytest.raises(ValueError, match="the action is"):
        seat.step(np.full(4, 5.0, np.float32))
    twin = twin_of(seat)
    assert twin.board is not None and twin.board.machine.motors.duties == (0.0, 0.0)
    with pytest.raises(ValueError, match=r"the table is stopped; call clear\(\) to play on, or reset\(\)"):
        seat.step(STAY)
    seat.clear()
    seat.game.rule["match_time"] = 0.05
    _, _, terminated, truncated, _ = seat.step(STAY)
    assert terminated or truncated
    with pytest.raises(ValueError, match=r"the episode is over; call reset\(\)"):
        seat.step(STAY)
    with pytest.raises(ValueError, match="nothing stopped the table"):
        seat.clear()


def test_a_closed_twin_frees_its_board(seat: RobotSeat) -> None:
    """Unicorn holds a gigabyte of addresses; a session of some hundred games would hold as many."""
    seat.reset(seed=1)
    board = twin_of(seat).board
    assert board is not None
    freed = weakref.ref(board.machine.cpu.uc)
    seat.close()
    assert freed() is None
