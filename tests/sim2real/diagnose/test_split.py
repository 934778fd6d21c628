"""The choice of the holdout: one of every few launches, with some of each kind of contact."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.split import _choose_holdout, launches_of, split_data
from sim2real.diagnose.tuned import SPLIT
from sim2real.recording.folder import read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording


def test_every_fifth_launch_is_held_out_where_all_have_every_contact():
    np.testing.assert_array_equal(_choose_holdout(5, np.ones((14, 6), int)), [4, 9])


def test_the_only_launch_with_contacts_at_a_wall_stays_in_the_training_data():
    """Launch 4 has all contacts with the second wall; the third wall has five contacts, one of them in launch 8."""
    counts = np.ones((10, 6), int)
    counts[:, 1], counts[4, 1] = 0, 6
    counts[:, 2] = [0, 0, 0, 0, 1, 0, 0, 1, 1, 2]
    np.testing.assert_array_equal(_choose_holdout(5, counts), [3, 8])


@pytest.mark.parametrize("walls, robots", [([0, 1], [4]), ([5, 6, 8], [2, 9]), ([0, 3], [3, 5])])
def test_the_holdout_has_contacts_with_walls_and_with_the_robot(walls, robots):
    counts = np.zeros((12, 6), int)
    counts[walls, 0], counts[robots, 5] = 2, 1
    held_out = _choose_holdout(4, counts)
    assert len(held_out) == 3 and len(np.unique(held_out)) == 3
    assert counts[held_out][:, [0, 5]].any(axis=0).all()


def test_the_only_launch_of_a_kind_is_not_replaced():
    counts = np.zeros((9, 6), int)
    counts[3, 0], counts[8, 0], counts[5, 5] = 3, 5, 1  # launch 3 is held out, 5 is not; 7 has no contact
    np.testing.assert_array_equal(_choose_holdout(4, counts), [3, 5])


def test_of_few_launches_the_last_is_held_out_and_of_one_none():
    np.testing.assert_array_equal(_choose_holdout(5, np.ones((3, 6), int)), [2])
    assert len(_choose_holdout(5, np.ones((1, 6), int))) == 0


def test_each_frame_is_in_one_part_and_a_path_goes_with_its_launches(tmp_path):
    make_recording(tmp_path / "one", Law(), "rally", 3, 30.0, dt=5e-5)
    recording = read_recording(tmp_path / "one")
    split = split_data([recording], [])
    (training,), (holdout,), (path,), (path_holdout,) = (
        split.training,
        split.holdout,
        split.gantry_training,
        split.gantry_holdout,
    )
    assert recording.frames is not None and training.frames is not None and holdout.frames is not None
    np.testing.assert_array_equal(np.sort(np.concatenate([training.frames.t, holdout.frames.t])), recording.frames.t)
    assert 0.5 / SPLIT.launches < holdout.frames.rows / recording.frames.rows < 2.0 / SPLIT.launches
    assert training.mallet is holdout.mallet is recording.mallet and path.frames is recording.frames
    assert path.mallet is not None and path_holdout.mallet is not None and recording.mallet is not None
    np.testing.assert_array_equal(np.sort(np.concatenate([path.mallet.t, path_holdout.mallet.t])), recording.mallet.t)
    frame = holdout.frames.t[
        np.clip(np.searchsorted(holdout.frames.t, path_holdout.mallet.t, side="right") - 1, 0, None)
    ]
    assert (path_holdout.mallet.t - frame).max() < 0.05  # it would be seconds if the launches differed


def test_launches_are_counted_through_all_recordings(tmp_path):
    for k in range(2):
        make_recording(tmp_path / f"{k}", Law(), "launches", k, 30.0, dt=5e-5)
    recordings = [read_recording(tmp_path / f"{k}") for k in range(2)]
    first, second = (np.unique(rows) for rows in launches_of(recordings, [segment(one) for one in recordings]))
    assert second[0] == first[-1] + 1 and len(first) > 3


def test_a_recording_of_the_gantry_alone_is_no_launch(tmp_path):
    make_recording(tmp_path / "one", Law(), "rally", 3, 20.0, dt=5e-5)
    recording = read_recording(tmp_path / "one")
    gantry = replace(recording, frames=None)
    recordings = [recording, gantry, recording]
    segments = [segment(one) for one in recordings]
    alone = launches_of([recording], segments[:1])[0]
    first, none, last = launches_of(recordings, segments)
    np.testing.assert_array_equal(first, alone)
    assert len(none) == 0 and last.min() == alone.max() + 1
