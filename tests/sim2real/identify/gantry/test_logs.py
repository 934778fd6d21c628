"""Logs: volts of the motors from their pwm or from plans, windows that no gap breaks, and what is refused."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from sim2real.identify.gantry.logs import parts, read_log, whole
from sim2real.identify.tuned import GANTRY
from sim2real.recording.folder import Recording, Stream
from tests.sim2real.identify.gantry.simulated import SUPPLY, log


@pytest.fixture(scope="module")
def recording() -> Recording:
    return log(1, 4.0)


def with_rows(one: Recording, stream: str, rows: np.ndarray) -> Recording:
    columns = {name: column[rows] for name, column in getattr(one, stream).columns.items()}
    return replace(one, **{stream: Stream(columns)})


def test_each_motor_gets_its_share_of_the_supply(recording: Recording) -> None:
    found = read_log(recording, SUPPLY)
    drive = recording.drive
    assert drive is not None and found.t == pytest.approx(drive.t[: len(found.t)])
    pwm = np.column_stack([drive["pwm_left"], drive["pwm_right"]])[: len(found.t)]
    assert found.volts[:-1] == pytest.approx(SUPPLY * pwm[:-1], abs=1e-9)


def test_plans_are_taken_where_no_pwm_was_logged(recording: Recording) -> None:
    plan = {"t": [0.0], "x_f": [0.5], "y_f": [0.5], "V_x": [6.0], "V_y": [-2.0]}
    plan |= {"t_x1": [0.1], "t_x2": [0.2], "t_y1": [0.15], "t_y2": [0.3]}
    commands = Stream({name: np.array(one) for name, one in plan.items()})
    found = read_log(replace(recording, drive=None, commands=commands), SUPPLY)
    for moment, axes in ((0.05, (6.0, -2.0)), (0.12, (-6.0, -2.0)), (0.16, (-6.0, 2.0)), (0.25, (0.0, 2.0))):
        left, right = found.volts[np.searchsorted(found.t, moment) - 1]
        assert (left - right, -left - right) == pytest.approx(axes)


def test_the_pwm_counts_where_both_were_recorded(recording: Recording) -> None:
    plan = {name: np.zeros(1) for name in ("t", "x_f", "y_f", "V_x", "V_y", "t_x1", "t_x2", "t_y1", "t_y2")}
    both = read_log(replace(recording, commands=Stream(plan)), SUPPLY)
    assert np.array_equal(both.volts, read_log(recording, SUPPLY).volts) and np.ptp(both.volts) > 10.0


def test_no_window_spans_a_gap_of_either_stream(recording: Recording) -> None:
    mallet, drive = recording.mallet, recording.drive
    assert mallet is not None and drive is not None
    seen = with_rows(recording, "mallet", (mallet.t < 2.0) | (mallet.t > 2.05))
    unknown = {name: column.copy() for name, column in drive.columns.items()}
    unknown["pwm_left"][(drive.t > 3.0) & (drive.t < 3.05)] = np.nan
    found = whole(read_log(replace(seen, drive=Stream(unknown)), SUPPLY))
    for windows in (found.fit, found.judge):
        begin, end = found.log.t[windows.begin], found.log.t[windows.ahead[:, -1]]
        assert not ((begin < 2.05) & (end > 2.0)).any() and not ((begin < 3.05) & (end > 3.0)).any()
        assert ((found.log.t[windows.start] - begin) >= GANTRY.past - 1e-3).all()
    assert len(found.fit.start) < len(whole(read_log(recording, SUPPLY)).fit.start)


def test_windows_look_as_far_ahead_as_they_say(recording: Recording) -> None:
    piece = whole(read_log(recording, SUPPLY))
    ahead = piece.log.t[piece.judge.ahead] - piece.log.t[piece.judge.start][:, None]
    assert ahead == pytest.approx(np.broadcast_to(GANTRY.judged, ahead.shape), abs=1e-3)


@pytest.mark.parametrize("gap", [0.1, 0.3, 0.6])
def test_windows_end_where_the_mallet_was_measured_last_before_the_motors_log_ends(
    recording: Recording, gap: float
) -> None:
    mallet, drive = recording.mallet, recording.drive
    assert mallet is not None and drive is not None
    ended = with_rows(recording, "drive", drive.t < 3.0)
    piece = whole(read_log(with_rows(ended, "mallet", (mallet.t < 3.0 - gap) | (mallet.t > 3.05)), SUPPLY))
    for windows, times in ((piece.fit, GANTRY.fitted), (piece.judge, GANTRY.judged)):
        ahead = piece.log.t[windows.ahead]
        assert 3.0 - gap - 0.2 < ahead.max() < 3.0 - gap
        assert ahead - piece.log.t[windows.start][:, None] == pytest.approx(np.tile(times, (len(ahead), 1)), abs=1e-3)
    assert all(len(part.fit.start) for part in parts(piece))


def test_no_window_looks_beyond_the_last_place_that_was_measured(recording: Recording) -> None:
    found = read_log(recording, SUPPLY)
    blind = replace(found, measured=found.t < 2.0)
    ahead = found.t[blind.windows(GANTRY.judge_every, GANTRY.judged).ahead]
    assert 1.95 < ahead.max() < 2.0
    nowhere = replace(found, measured=np.zeros_like(found.measured))
    assert not len(nowhere.windows(GANTRY.judge_every, GANTRY.judged).start)


def test_parts_of_a_log_share_no_moment(recording: Recording) -> None:
    found = parts(whole(read_log(recording, SUPPLY)))
    assert len(found) == GANTRY.parts
    spans = [(one.log.t[one.judge.begin[0]], one.log.t[one.judge.ahead[-1, -1]]) for one in found]
    assert all(end <= begin for (_, end), (begin, _) in pairwise(spans))


def test_what_holds_no_log_is_refused_in_one_line(recording: Recording) -> None:
    mallet, drive = recording.mallet, recording.drive
    assert mallet is not None and drive is not None
    blank = replace(mallet, columns={**mallet.columns, "mallet_x": np.full(mallet.rows, np.nan)})
    late = replace(drive, columns={**drive.columns, "t": drive.t + 10.0})
    still = {name: np.full(mallet.rows, 0.3) for name in ("mallet_x", "mallet_y")}
    at_rest = replace(mallet, columns={**mallet.columns, **still})
    faults = {
        "the mallet's path was not recorded": replace(recording, mallet=None),
        "mallet.csv holds no place; expected the mallet's path": replace(recording, mallet=blank),
        "the streams do not overlap in time: .* from 0 to 3.9.* s, and none is between 10 and 13.9": replace(
            recording, drive=late
        ),
        "the streams do not overlap in time: .* and none is between 1.5.* and 2.4": with_rows(
            with_rows(recording, "drive", (drive.t > 1.5) & (drive.t < 2.5)),
            "mallet",
            (mallet.t < 1.0) | (mallet.t > 3.0),
        ),
        "neither the motors' log": replace(recording, drive=None),
        "windows of 0.2 s without a gap": with_rows(recording, "mallet", mallet.t < 1.0),
        "the mallet moves by 0.0 mm in all; expected 10 mm or more": replace(recording, mallet=at_rest),
        "record the mallet at 500 Hz or more": with_rows(recording, "mallet", np.arange(mallet.rows) % 8 == 0),
    }
    for words, one in faults.items():
        with pytest.raises(ValueError, match=words) as error:
            whole(read_log(one, SUPPLY))
        assert "\n" not in str(error.value)
