"""The check that two recordings are of one table and one camera, by places and times of contacts."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.input_checks import UndeterminedError
from sim2real.diagnose.regimes.sensing.consistency import check_sensing
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording

Change = Callable[[np.ndarray], np.ndarray]


@pytest.fixture(scope="module")
def rallies(tmp_path_factory) -> list[Recording]:
    """Two recordings of one table and one camera."""
    folders = [tmp_path_factory.mktemp("rally") / name for name in ("one", "other")]
    for seed, folder in enumerate(folders):
        make_recording(folder, Law(camera_delay=0.015), "rally", 1 + 2 * seed, 30.0, dt=1e-4)
    return [read_recording(folder) for folder in folders]


def changed(recording: Recording, **columns: Change) -> Recording:
    """`recording` with other values in columns of its frames."""
    assert recording.frames is not None
    fresh = {name: change(recording.frames[name]) for name, change in columns.items()}
    return replace(recording, frames=Stream({**recording.frames.columns, **fresh}))


def check(*recordings: Recording) -> None:
    check_sensing(recordings, [segment(one) for one in recordings])


def test_one_table_and_one_camera_agree(rallies):
    check(*rallies)


def test_a_camera_that_is_later_in_one_of_them_is_another(rallies):
    with pytest.raises(UndeterminedError, match=r"one and other are not of one table.* delays differ by (19|20|21) ms"):
        check(rallies[0], changed(rallies[1], t=lambda t: t + 0.02))


def test_a_table_stretched_by_a_little_is_another(rallies):
    with pytest.raises(UndeterminedError, match=r"bounces differ by (1\.7|1\.8|1\.9)%"):
        check(changed(rallies[0], puck_x=lambda x: 1.009 * x), changed(rallies[1], puck_x=lambda x: 0.991 * x))


def test_a_recording_without_a_puck_contradicts_none(rallies):
    """Such a recording determines no scale, which does not mean that the scale is exact."""
    nothing = Stream({name: column[:0] for name, column in rallies[1].frames.columns.items()})
    check(changed(rallies[0], puck_x=lambda x: 1.012 * x), replace(rallies[1], frames=nothing))


def test_an_assumed_size_with_a_small_error_is_no_stretched_map(rallies):
    unknown = {**rallies[0].meta, "table": {**rallies[0].meta["table"], "length_m": None}}
    with pytest.raises(
        UndeterminedError, match=r"assumed length of 2\.000 m differs by 1\.[0-4]% from the observed 2\.02\d m"
    ):
        check(*(replace(changed(one, puck_x=lambda x: 1.012 * x), meta=unknown) for one in rallies))
