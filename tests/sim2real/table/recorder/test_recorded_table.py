"""What is recorded of a table: rows of all streams on one clock, against what a scripted table shows and takes."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim2real.recording.folder import RecordingError, read_recording
from sim2real.recording.table_parameters import recording_meta, stated_sizes
from sim2real.table.backend import Backend, Motion, Place, Reading, SeenFrame, SeenMallet
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.robot_seat import RobotSeat
from sim2real.table.mallet_driver import MalletDriver, MalletPlan
from sim2real.table.recorder.draft import RecordingDraft
from sim2real.table.recorder.recorded_game import recorded
from sim2real.table.recorder.recorded_table import RecordedTable

HOME = (0.25, 0.5)
BEGIN = 100.0  # s of the host's clock


class ScriptedTable(Backend):
    """Shows what it was given, reading by reading, and remembers what was asked of it."""

    obeys, patience, frame_rate = False, 7.0, 90.0

    def __init__(self, readings: list[Reading]) -> None:
        self.readings, self.asked, self.time = readings, [], BEGIN

    def seed(self, seed: int) -> None:
        self.asked.append("seed")

    def connect(self, home: Place) -> None:
        self.asked.append("connect")

    def clear(self, home: Place) -> None:
        self.asked.append("clear")

    def now(self) -> float:
        return self.time

    def wait(self, until: float) -> None:
        self.time = until

    def wait_for_frame(self, until: float) -> None:
        self.time = until

    def place(self) -> Place:
        return HOME

    def mallet_motion(self, time: float) -> Motion:
        return time, 0.0, 0.0, 0.0

    def read(self) -> Reading:
        return self.readings.pop(0)

    def send(self, plan: MalletPlan) -> MalletPlan:
        return plan

    def stop(self) -> None:
        self.asked.append("stop")

    def place_puck(self, puck: np.ndarray) -> None:
        self.asked.append("place_puck")

    def show(self, game: np.void) -> None:
        self.asked.append("show")

    def close(self) -> None:
        self.asked.append("close")


@pytest.fixture(scope="module")
def game() -> GameRecord:
    return GameRecord("puckpilot/match-v0", {"friction": 0.1, "width": 0.98})


def mallet(time: float) -> SeenMallet:
    return SeenMallet(time, (0.3, 0.4), (0.31, 0.41), (0.1, -0.2), round(1e6 * time))


def test_all_streams_start_at_zero_of_one_clock(game: GameRecord, tmp_path: Path) -> None:
    first = Reading([SeenFrame(BEGIN + 0.001, None, (1.5, 0.5))], [mallet(BEGIN), mallet(BEGIN + 0.002)])
    second = Reading([SeenFrame(BEGIN + 0.009, (1.0, 0.6), None)], [mallet(BEGIN + 0.004)])
    draft = RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, "a test"))
    table = RecordedTable(ScriptedTable([Reading(), first, second]), draft, game.p)
    driver = MalletDriver(game.p)
    driver.stand(*HOME, BEGIN)
    table.send(driver.plan([0.6, 0.3, 8.0, 5.0], BEGIN + 0.014))
    for _ in range(3):
        table.read()
    table.close()
    assert draft.finish()
    found = read_recording(tmp_path / "one")
    assert found.frames and found.mallet and found.commands and found.drive
    np.testing.assert_allclose(found.frames.t, [0.001, 0.009])
    np.testing.assert_array_equal(found.frames["puck_x"], [np.nan, 1.0])
    np.testing.assert_array_equal(found.frames["opponent_y"], [0.5, np.nan])
    np.testing.assert_allclose(found.mallet.t, [0.0, 0.002, 0.004])
    assert found.mallet["mallet_x"].tolist() == [0.3] * 3 and found.mallet["expected_y"].tolist() == [0.41] * 3
    np.testing.assert_allclose(found.drive.t, [0.0, 0.001, 0.002, 0.003, 0.004])
    assert found.drive["pwm_right"].tolist() == [-0.2] * 5
    row = {name: float(column[0]) for name, column in found.commands.items()}
    assert (row["t"], row["V_x"], row["V_y"]) == pytest.approx((0.014, 8.0, -5.0), abs=1e-6)
    assert (row["x_f"], row["y_f"]) == pytest.approx((0.6, 0.3), abs=1e-5)
    assert 0.0 < row["t_x1"] < row["t_x2"] and 0.0 < row["t_y1"] < row["t_y2"]
    assert found.nominal("camera", "rate_hz") == 120.0
    assert stated_sizes(found)["width"] == 0.98 and stated_sizes(found)["max_voltage"] == 24.0


def test_a_plan_comes_to_rest_where_the_row_says(game: GameRecord, tmp_path: Path) -> None:
    """From any state: the final place is where the plan's own motion ends."""
    draft = RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, "a test"))
    table = RecordedTable(ScriptedTable([Reading([], [mallet(BEGIN)])]), draft, game.p)
    driver, random, ends = MalletDriver(game.p), np.random.default_rng(1), []
    driver.stand(*HOME, BEGIN)
    for k in range(20):
        target = random.uniform([0.1, 0.1], [0.9, 0.9])
        table.send(driver.plan([*target, *random.uniform(4.0, 14.0, 2)], BEGIN + 0.1 * k))
        ends.append(driver.motion(BEGIN + 0.1 * k + 5.0)[:2])
    table.read()
    table.close()  # plans that do not act yet are kept then
    draft.finish()
    commands = read_recording(tmp_path / "one").commands
    assert commands is not None
    np.testing.assert_allclose(np.column_stack([commands["x_f"], commands["y_f"]]), ends, atol=2e-6)


def test_the_table_behind_it_is_asked_for_everything(game: GameRecord, tmp_path: Path) -> None:
    behind = ScriptedTable([Reading([], [mallet(BEGIN)])])
    table = RecordedTable(behind, RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, "")), game.p)
    table.seed(1)
    table.connect(HOME)
    table.clear(HOME)
    table.wait(BEGIN + 1.0)
    table.wait_for_frame(BEGIN + 2.0)
    table.place_puck(np.zeros(4))
    table.show(game.record)
    table.stop()
    table.close()
    assert not behind.readings  # what came while the clock's estimate moved is not recorded
    assert behind.asked == ["seed", "connect", "clear", "place_puck", "show", "stop", "close"]
    assert (table.now(), table.place(), table.patience, table.obeys) == (BEGIN + 2.0, HOME, 7.0, False)
    assert table.mallet_motion(BEGIN) == (BEGIN, 0.0, 0.0, 0.0) and table.frame_rate == 90.0


def test_a_reading_is_passed_on_whole(game: GameRecord, tmp_path: Path) -> None:
    reading = Reading([], [mallet(BEGIN)], 0.004, 3, True)
    table = RecordedTable(
        ScriptedTable([reading]), RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, "")), game.p
    )
    assert table.read() is reading


def test_what_came_until_an_error_is_recorded(game: GameRecord, tmp_path: Path) -> None:
    behind = ScriptedTable([Reading([], [mallet(BEGIN)])])
    env = RobotSeat(behind, game)
    with pytest.raises(KeyboardInterrupt), recorded(env, tmp_path / "one", "a test"):
        env.backend.read()
        raise KeyboardInterrupt
    assert env.backend is behind and behind.asked == ["close"]
    found = read_recording(tmp_path / "one")
    assert found.mallet is not None and found.mallet.rows == 1
    assert found.meta["note"].startswith("a test; drive.csv: every second row is telemetry")


def test_a_folder_that_exists_is_refused_before_anything_moves(game: GameRecord, tmp_path: Path) -> None:
    behind = ScriptedTable([])
    with pytest.raises(RecordingError, match="exists already"), recorded(RobotSeat(behind, game), tmp_path, "a test"):
        pass
    assert not behind.asked


@pytest.mark.parametrize("stops", [False, True])
def test_a_plan_that_was_not_followed_is_not_in_the_recording(game: GameRecord, tmp_path: Path, stops: bool) -> None:
    """Because it was lost on the line, which is known some milliseconds after its begin, or the table had stopped."""
    readings = [
        Reading([], [mallet(BEGIN)]), Reading([], [mallet(BEGIN + 0.05)]), Reading([], [mallet(BEGIN + 0.2)]),
        Reading([], [mallet(BEGIN + 0.212)], missed=0 if stops else 1),
    ]  # fmt: skip
    draft = RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, "a test"))
    table = RecordedTable(ScriptedTable(readings), draft, game.p)
    driver = MalletDriver(game.p)
    driver.stand(*HOME, BEGIN)
    table.read()
    for begin in (BEGIN + 0.014, BEGIN + 0.205):
        table.send(driver.plan([0.6, 0.3, 8.0, 5.0], begin))
        table.wait(begin - 0.005 if stops and begin > BEGIN + 0.1 else begin + 0.007)
        table.read()
    if stops:
        table.stop()
    table.read()
    table.close()
    assert draft.finish()
    found = read_recording(tmp_path / "one")
    assert found.commands and found.commands.t == pytest.approx([0.014])


def test_a_disk_that_is_full_does_not_keep_the_table_from_being_closed(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    game = GameRecord("puckpilot/match-v0")
    behind = ScriptedTable([Reading([SeenFrame(BEGIN, (1.0, 0.5), (1.7, 0.5))], [])])
    draft = RecordingDraft(tmp_path / "one", recording_meta(game.p, 120.0, ""))
    table = RecordedTable(behind, draft, game.p)
    table.read()

    def full(*_: object) -> None:
        raise OSError("No space left on device")

    monkeypatch.setattr(draft, "add", full)
    with pytest.raises(OSError, match="No space left"):
        table.close()
    assert behind.asked == ["close"]
