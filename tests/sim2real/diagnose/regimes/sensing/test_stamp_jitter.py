"""Stamps that are arrivals of regular exposures: made here, added to recordings of an independent table, and real."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.regimes.sensing.identify import identify_sensing, prove_sensing
from sim2real.diagnose.regimes.sensing.regular_exposures import regular_exposures
from sim2real.diagnose.regimes.sensing.stamp_jitter import identify_stamps, with_regular_stamps
from sim2real.diagnose.split import launches_of
from sim2real.recording.folder import Recording, Stream, read_recording
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording
from tests.places import UBC

PERIOD, ARRIVAL = 1.0 / 119.97, 0.0006  # s
REGULAR = Camera(noise=1e-4, jitter=0.0)


@pytest.fixture(scope="module")
def launches(tmp_path_factory) -> Recording:
    folder = tmp_path_factory.mktemp("launches")
    make_recording(folder, Law(), "launches", 3, 60.0, replace(REGULAR, arrival=ARRIVAL), dt=5e-5)
    return read_recording(folder)


def identified(recording: Recording):
    segments = [segment(recording)]
    return identify_stamps([recording], segments, launches_of([recording], segments))


def shown() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Exposures [s] with their numbers, and stamps [s]: late by 0.1 ms or so, after a clock that wanders by 2 ms; one
    frame of a hundred is skipped, and one of two hundred waits for 1.4 periods, with the next right behind it."""
    rng = np.random.default_rng(5)
    number = np.flatnonzero(rng.uniform(size=7200) > 0.01)
    exposed = PERIOD * number
    stamps = exposed + 0.002 * np.sin(exposed / 15.0) + rng.gamma(2.0, 7e-5, len(exposed))
    stuck = np.flatnonzero(rng.uniform(size=len(stamps) - 1) < 0.005)
    stamps[stuck] += 1.4 * PERIOD
    stamps[stuck + 1] = np.maximum(stamps[stuck + 1], stamps[stuck] + 0.3 * PERIOD)
    return exposed, number, np.maximum.accumulate(stamps)


def test_exposures_and_skipped_frames_are_found_behind_late_stamps_and_a_clock_that_wanders() -> None:
    exposed, number, stamps = shown()
    found = regular_exposures(stamps)
    assert found is not None and found.sure.mean() > 0.97
    assert found.period == pytest.approx(PERIOD, rel=5e-5)
    steps = np.diff(number[found.sure])
    assert np.array_equal(np.diff(found.number[found.sure]), steps)
    spacing = np.diff(found.t[found.sure]) - np.diff((exposed + 0.002 * np.sin(exposed / 15.0))[found.sure])
    assert np.abs(spacing).max() < 1e-5  # the stamps' own are off by 200 us and more
    assert (np.diff(found.t) > 0).all()


@pytest.mark.parametrize("stamps", [np.zeros(0), np.arange(10) / 120.0])
def test_too_few_stamps_show_no_period(stamps: np.ndarray) -> None:
    assert regular_exposures(stamps) is None


@pytest.mark.parametrize("stamps", [np.zeros(500), np.arange(500.0)[::-1] / 120.0, np.repeat(np.arange(900) / 60.0, 2)])
def test_stamps_that_do_not_grow_show_no_period(stamps: np.ndarray) -> None:
    assert regular_exposures(stamps) is None


def test_stamps_of_whole_milliseconds_show_the_period_between() -> None:
    found = regular_exposures(np.round(np.arange(2400) / 120.0, 3))
    assert found is not None and found.period == pytest.approx(1.0 / 120.0, rel=1e-5)


def test_late_frames_beside_a_gap_and_at_the_ends_get_times_where_they_came() -> None:
    stamps = np.concatenate([np.arange(1200), 4000 + np.arange(1200)]) / 120.0
    late = [0, 1199, 1200, 2399]
    stamps[late] += 0.3 / 120.0
    found = regular_exposures(stamps)
    assert found is not None and np.array_equal(np.flatnonzero(~found.sure), late)
    assert (np.diff(found.t) > 0.0).all()
    assert np.abs(found.t - stamps)[late].max() < 1.0 / 120.0


def test_frames_at_any_time_show_no_period() -> None:
    rng = np.random.default_rng(1)
    assert regular_exposures(np.cumsum(rng.uniform(0.004, 0.012, 5000))) is None


def test_arrivals_are_named_and_measured_and_the_fit_improves_where_nothing_was_fitted(launches, tmp_path) -> None:
    segments = [segment(launches)]
    launch = launches_of([launches], segments)
    sensed = identify_sensing([launches], segments, launch)
    assert [one.mechanism for one in sensed.regime_result.findings] == ["stamp_jitter"]
    numbers = sensed.regime_result.findings[0].parameters
    assert numbers["period_s"].value == pytest.approx(1.0 / 120.0, rel=1e-4)
    assert numbers["std_s"].low < ARRIVAL < numbers["std_s"].high
    assert numbers["std_s"].value == pytest.approx(ARRIVAL, rel=0.1)
    make_recording(tmp_path, Law(), "launches", 4, 30.0, replace(REGULAR, arrival=ARRIVAL), dt=5e-5)
    other = read_recording(tmp_path)
    parts = [segment(other)]
    proof = prove_sensing(sensed, [other], parts, launches_of([other], parts)).proof
    assert proof is not None and proof.after_m < 1.2e-4 < 2.0e-4 < proof.before_m  # the sensor's noise is 1e-4
    assert segment(sensed.correct(other)).noise.clock == 0.0 < parts[0].noise.clock


def test_a_recording_that_shows_no_period_by_itself_has_that_of_its_camera(launches) -> None:
    """Nothing for the recordings beside it, and corrected with them: one without frames, and one of two seconds."""
    assert launches.frames is not None
    short = {name: values[:240] for name, values in launches.frames.columns.items()}
    three = [launches, replace(launches, frames=None), replace(launches, frames=Stream(short))]
    segments = [segment(one) for one in three]
    found = identify_stamps(three, segments, launches_of(three, segments))
    assert found.finding is not None and found.period == pytest.approx(1.0 / 120.0, rel=1e-4)
    corrected = with_regular_stamps(three[2], found.period).frames
    assert corrected is not None
    assert np.std(np.diff(corrected.t)) < 0.1 * ARRIVAL < np.std(np.diff(short["t"]))


def test_ten_seconds_are_too_few_to_say(launches) -> None:
    assert launches.frames is not None
    short = {name: values[:900] for name, values in launches.frames.columns.items()}
    assert identified(replace(launches, frames=Stream(short))).finding is None


def test_stamps_that_show_when_frames_were_exposed_are_left_alone(tmp_path) -> None:
    """Exposures jitter by as much as the arrivals above, and the stamps say so."""
    make_recording(tmp_path, Law(), "launches", 3, 60.0, replace(REGULAR, jitter=ARRIVAL), dt=5e-5)
    assert identified(read_recording(tmp_path)).finding is None


def test_regular_exposures_with_their_own_stamps_are_left_alone(tmp_path) -> None:
    make_recording(tmp_path, Law(), "launches", 3, 60.0, REGULAR, dt=5e-5)
    assert identified(read_recording(tmp_path)).finding is None


def test_stamps_that_are_rounded_to_microseconds_are_left_alone(tmp_path) -> None:
    """As an exact recording shows them: it is sure that they are rounded, and it moves a fast puck by a micrometre."""
    exact = replace(REGULAR, noise=1e-7)
    make_recording(tmp_path / "exact", Law(), "launches", 3, 60.0, exact, dt=5e-5)
    recording = read_recording(tmp_path / "exact")
    assert recording.frames is not None
    columns = {**recording.frames.columns, "t": np.round(recording.frames.t, 6)}
    assert identified(replace(recording, frames=Stream(columns))).finding is None


def test_what_a_frame_saw_at_an_unsure_time_is_not_used(launches) -> None:
    assert launches.frames is not None
    stamps = launches.frames.t.copy()
    stamps[1000] += 1.4 / 120.0
    late = replace(launches, frames=Stream({**launches.frames.columns, "t": np.sort(stamps)}))
    corrected = with_regular_stamps(late)
    assert corrected.frames is not None and np.isnan(corrected.frames["puck_x"][1000:1002]).any()
    assert (np.diff(corrected.frames.t) > 0).all()


@pytest.mark.parametrize(("name", "before", "after"), [("puck_a", 2.2e-4, 1.6e-4), ("play_a", 1.8e-4, 1.5e-4)])
def test_stamps_of_the_real_table_are_arrivals(name: str, before: float, after: float) -> None:
    if not (UBC / name).is_dir():
        pytest.skip(f"{name} is not there")
    found = identified(read_recording(UBC / name).from_zero())
    assert found.finding is not None and found.selection is not None
    assert found.selection.before_m > before and found.selection.after_m < after
