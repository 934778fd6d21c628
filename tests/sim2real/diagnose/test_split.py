"""Which launches prove: about every fifth, but some of each kind of contact; and what is left then."""

import numpy as np
import pytest

from sim2real.diagnose.split import _every, launches_of, split_data
from sim2real.diagnose.tuned import SPLIT
from sim2real.recording.folder import read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording


def test_every_fifth_launch_is_taken_where_all_meet_everything():
    np.testing.assert_array_equal(_every(5, np.ones((14, 6), int)), [4, 9])


def test_a_launch_that_alone_met_a_wall_is_left_to_the_fits():
    """Number 4 has all touches of the second wall; of the third there are five, of which number 8 takes one."""
    met = np.ones((10, 6), int)
    met[:, 1], met[4, 1] = 0, 6
    met[:, 2] = [0, 0, 0, 0, 1, 0, 0, 1, 1, 2]
    np.testing.assert_array_equal(_every(5, met), [3, 8])


@pytest.mark.parametrize("walls, robots", [([0, 1], [4]), ([5, 6, 8], [2, 9]), ([0, 3], [3, 5])])
def test_some_of_those_taken_meet_walls_and_some_the_robot(walls, robots):
    met = np.zeros((12, 6), int)
    met[walls, 0], met[robots, 5] = 2, 1
    taken = _every(4, met)
    assert len(taken) == 3 and len(np.unique(taken)) == 3
    assert met[taken][:, [0, 5]].any(axis=0).all()


def test_a_kind_that_one_launch_alone_has_met_is_not_given_up_for_another():
    met = np.zeros((9, 6), int)
    met[3, 0], met[8, 0], met[5, 5] = 3, 5, 1  # launch 3 is taken, 5 is not; 7 met nothing
    np.testing.assert_array_equal(_every(4, met), [3, 5])


def test_of_few_launches_the_last_is_taken_and_of_one_none():
    np.testing.assert_array_equal(_every(5, np.ones((3, 6), int)), [2])
    assert len(_every(5, np.ones((1, 6), int))) == 0


def test_each_frame_is_in_one_part_and_a_path_goes_with_its_launches(tmp_path):
    make_recording(tmp_path / "one", Law(), "rally", 3, 30.0, dt=5e-5)
    recording = read_recording(tmp_path / "one")
    divided = split_data([recording], [])
    (rest,), (proof,), (path,), (path_proof,) = (
        divided.training,
        divided.holdout,
        divided.gantry_training,
        divided.gantry_holdout,
    )
    assert recording.frames is not None and rest.frames is not None and proof.frames is not None
    np.testing.assert_array_equal(np.sort(np.concatenate([rest.frames.t, proof.frames.t])), recording.frames.t)
    assert 0.5 / SPLIT.launches < proof.frames.rows / recording.frames.rows < 2.0 / SPLIT.launches
    assert rest.mallet is proof.mallet is recording.mallet and path.frames is recording.frames
    assert path.mallet is not None and path_proof.mallet is not None and recording.mallet is not None
    np.testing.assert_array_equal(np.sort(np.concatenate([path.mallet.t, path_proof.mallet.t])), recording.mallet.t)
    frame = proof.frames.t[np.clip(np.searchsorted(proof.frames.t, path_proof.mallet.t, side="right") - 1, 0, None)]
    assert np.median(path_proof.mallet.t - frame) < 0.02  # seconds, if other launches were meant


def test_launches_are_counted_through_all_recordings(tmp_path):
    for k in range(2):
        make_recording(tmp_path / f"{k}", Law(), "launches", k, 30.0, dt=5e-5)
    recordings = [read_recording(tmp_path / f"{k}") for k in range(2)]
    first, second = (np.unique(rows) for rows in launches_of(recordings, [segment(one) for one in recordings]))
    assert second[0] == first[-1] + 1 and len(first) > 3
