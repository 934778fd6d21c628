"""Tracking on known paths: straight between walls that reflect, contacts, and times without measurements."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sim2real.vision.track.kalman_tracker import KalmanTracker, Measurement, TrackState

LENGTH, WIDTH, RADIUS = 2.0, 1.0, 0.0309
POWER, NOISE = 0.01, 0.05e-3
Path = Callable[[float], np.ndarray]


def mirrored(start: tuple[float, float], velocity: tuple[float, float]) -> Path:
    """Straight on an unfolded table, folded back: a saw-tooth for each axis."""

    def at(time: float) -> np.ndarray:
        low, high = np.full(2, RADIUS), np.array([LENGTH, WIDTH]) - RADIUS
        far = (np.array(start) + time * np.array(velocity) - low) % (2.0 * (high - low))
        return low + np.minimum(far, 2.0 * (high - low) - far)

    return at


def seen(place: np.ndarray, rng: np.random.Generator, sure: bool = True) -> Measurement:
    return Measurement(place + rng.normal(0.0, NOISE, 2), NOISE**2 * np.eye(2), sure)


def track(path: Path, rate: float, pictures: int, hidden=lambda time: False) -> list[tuple[float, TrackState | None]]:
    rng, tracker = np.random.default_rng(0), KalmanTracker(POWER)
    times = np.arange(pictures) / rate
    return [(t, tracker.update(t, [] if hidden(t) else [seen(path(t), rng)])) for t in times]


def off(path: Path, found: list[tuple[float, TrackState | None]]) -> np.ndarray:
    """Of what is known: error [m], and its square in standard deviations."""
    rows = []
    for time, state in found:
        if state is not None:
            error = state.place - path(time)
            square = error @ np.linalg.solve(state.covariance[:2, :2], error)
            rows.append((float(np.linalg.norm(error)), float(square)))
    return np.array(rows)


@pytest.mark.parametrize("seed", range(5))
def test_a_step_is_the_textbooks(seed: int):
    """Predict and correct with matrices (Kalman 1960; white acceleration: Bar-Shalom et al. 2001, 6.2.2)."""
    rng = np.random.default_rng(seed)
    half, error = rng.normal(size=(4, 4)), rng.normal(size=(2, 2))
    before = TrackState(1.0, rng.normal(size=2), rng.normal(size=2), half @ half.T, 3)
    one = Measurement(rng.normal(size=2), error @ error.T, True)
    dt, eye = 0.3, np.eye(2)
    on = np.block([[eye, dt * eye], [0.0 * eye, eye]])
    grown = POWER * np.block([[dt**3 / 3.0 * eye, dt**2 / 2.0 * eye], [dt**2 / 2.0 * eye, dt * eye]])
    state, spread = on @ np.r_[before.place, before.velocity], on @ before.covariance @ on.T + grown
    there = before.predicted(1.3, POWER)
    np.testing.assert_allclose(np.r_[there.place, there.velocity], state)
    np.testing.assert_allclose(there.covariance, spread)
    look = np.hstack([eye, 0.0 * eye])
    sum_of_both, off = look @ spread @ look.T + one.covariance, one.place - look @ state
    gain = spread @ look.T @ np.linalg.inv(sum_of_both)
    assert there.squared_distance(one) == pytest.approx(off @ np.linalg.inv(sum_of_both) @ off)
    after = there.updated(one)
    np.testing.assert_allclose(np.r_[after.place, after.velocity], state + gain @ off)
    np.testing.assert_allclose(after.covariance, (np.eye(4) - gain @ look) @ spread, atol=1e-12)
    assert (after.time, after.pictures) == (1.3, 4)


@pytest.mark.parametrize("rate", [100.0, 120.0, 200.0])
@pytest.mark.parametrize("velocity", [(0.0, 0.0), (1.3, 0.4), (-4.0, 3.0), (0.3, -9.0)])
def test_between_walls_it_is_known_from_the_second_picture_on_and_within_its_deviations(rate, velocity):
    path = mirrored((0.7, 0.4), velocity)
    found = track(path, rate, 400)
    assert found[0][1] is None and all(state is not None for _, state in found[1:])
    far = off(path, found)
    assert far[:, 0].max() < 0.4e-3 and 0.01 < (far[:, 1] > 5.99).mean() < 0.1 and (far[:, 1] > 16.0).mean() < 0.01


def test_on_a_straight_path_no_measurement_is_taken_for_a_contact():
    """A contact would leave the velocity unknown; of 3,000 measurements one lies farther off than four deviations."""
    path = lambda t: np.array([0.1, 0.1]) + t * np.array([0.5, 0.2])  # noqa: E731
    found = track(path, 120.0, 400)
    assert max(state.covariance[2, 2] for _, state in found[5:] if state is not None) < 0.1**2


def test_the_velocity_is_that_of_the_path():
    last = track(mirrored((0.3, 0.3), (1.0, 0.5)), 120.0, 60)[-1][1]
    assert last is not None
    deviation = float(np.sqrt(last.covariance[2, 2]))
    assert last.velocity == pytest.approx((1.0, 0.5), abs=4.0 * deviation) and deviation < 0.03


def test_after_a_blow_it_goes_on_at_once_and_owns_that_its_velocity_is_not_known():
    contact = 0.5
    before, after = mirrored((0.5, 0.5), (-1.0, 0.0)), mirrored((0.1, 0.5), (6.0, 1.0))
    path = lambda t: before(t) if t < contact else before(contact) + after(t - contact) - after(0.0)  # noqa: E731
    found = track(path, 120.0, 90)
    assert off(path, found)[:, 0].max() < 0.4e-3 and all(state is not None for _, state in found[1:])
    first = next(state for time, state in found if state is not None and time > contact + 1e-9)
    assert np.sqrt(first.covariance[2, 2]) > 1.0
    last = found[-1][1]
    assert last is not None
    assert last.velocity == pytest.approx((6.0, 1.0), abs=0.1)


@pytest.mark.parametrize("rate", [100.0, 200.0])
@pytest.mark.parametrize("hidden", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("contact_inside", [False, True])
def test_under_the_gantry_the_state_is_unknown_and_soon_after_known(rate, hidden, contact_inside):
    """Two pictures after it comes out it is known again, whether it was struck in there or not."""
    begin, end = 0.3, 0.3 + hidden
    free, away = mirrored((0.9, 0.3), (-1.5, 0.3)), mirrored((0.9, 0.3), (5.0, 1.0))
    turn = 0.5 * (begin + end)
    path = lambda t: free(t) if t < turn or not contact_inside else free(turn) + away(t - turn) - away(0.0)  # noqa: E731
    found = track(path, rate, int((end + 0.1) * rate), lambda t: begin <= t < end)
    assert all(state is None for time, state in found if begin <= time < end - 1e-9)
    assert all(state is not None for time, state in found if time >= end + 1.0 / rate)
    assert off(path, found)[:, 0].max() < 0.4e-3


@pytest.mark.parametrize("rate", [100.0, 120.0, 200.0])
@pytest.mark.parametrize("speed", [6.0, 9.0, 14.0])
@pytest.mark.parametrize("hidden", [0.015, 0.03, 0.045])
def test_turned_back_under_the_gantry_it_is_known_from_the_second_picture_on(rate, speed, hidden):
    begin, end = 0.05, 0.05 + hidden
    path = lambda t: np.array([1.2 - speed * (t if t < begin else 2.0 * begin - t), 0.5])  # noqa: E731
    found = track(path, rate, int((end + 0.1) * rate), lambda t: begin < t < end)
    assert all(state is not None for time, state in found if time >= end + 1.0 / rate)
    assert off(path, found)[:, 0].max() < 0.4e-3


@pytest.mark.parametrize("before", [0.3, 0.35])
def test_one_false_measurement_while_it_is_hidden_is_rejected(before):
    """Not even if it was struck in the last picture that showed it, so that nobody knows its velocity."""
    rng, tracker = np.random.default_rng(0), KalmanTracker(POWER)
    for k in range(30):
        tracker.update(k / 120.0, [seen(np.array([0.3 if k == 29 else before, 0.5]), rng)])
    assert all(tracker.update(k / 120.0, []) is None for k in range(30, 35))
    assert tracker.update(35 / 120.0, [seen(np.array([0.7, 0.5]), rng)]) is None
    assert tracker.update(36 / 120.0, []) is None
    for k in range(37, 60):
        last = tracker.update(k / 120.0, [seen(np.array([0.3, 0.5]), rng)])
        assert (last is not None) == (k > 37)


def test_a_false_first_measurement_costs_two_pictures():
    path, rng, tracker = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), KalmanTracker(POWER)
    assert tracker.update(0.0, [seen(np.array([1.5, 0.5]), rng)]) is None
    found = [tracker.update(k / 120.0, [seen(path(k / 120.0), rng)]) for k in (1, 2)]
    assert found[0] is None and found[1] is not None


def test_a_false_measurement_beside_the_track_is_ignored():
    path, rng, tracker = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), KalmanTracker(POWER)
    still = np.array([0.62, 0.46])  # its way leads past it
    found = []
    for k in range(100):
        places = [path(k / 120.0)] if k < 3 else [still, path(k / 120.0)]
        found.append((k / 120.0, tracker.update(k / 120.0, [seen(place, rng) for place in places])))
    assert off(path, found)[:, 0].max() < 0.4e-3 and len(off(path, found)) == 99


def test_of_two_possible_objects_neither_is_tracked():
    rng, tracker = np.random.default_rng(0), KalmanTracker(POWER)
    for k in range(30):
        both = [seen(np.array([0.5, 0.5]), rng), seen(np.array([1.5, 0.5]), rng)]
        assert tracker.update(k / 120.0, both) is None


def test_ambiguous_measurements_start_no_track_but_continue_one():
    rng, tracker = np.random.default_rng(0), KalmanTracker(POWER)
    place = np.array([0.5, 0.5])
    assert all(tracker.update(k / 120.0, [seen(place, rng, sure=False)]) is None for k in range(10))
    for k in range(10, 20):
        tracker.update(k / 120.0, [seen(place, rng)])
    assert tracker.update(20 / 120.0, [seen(place, rng, sure=False)]) is not None
    assert tracker.update(21 / 120.0, [seen(place + 0.3, rng, sure=False)]) is None


@pytest.mark.parametrize("rate", [100.0, 120.0])
def test_an_ambiguous_measurement_does_not_confirm_a_track(rate):
    rng, tracker = np.random.default_rng(0), KalmanTracker(POWER)
    tracker.update(0.0, [seen(np.array([0.5, 0.5]), rng)])
    assert tracker.update(1.0 / rate, [seen(np.array([0.505, 0.5]), rng, sure=False)]) is None


def test_an_object_moved_by_hand_is_found_again():
    """It jumps 1.5 m, farther than it can fly in less than 0.1 s: not known until then and in one picture more."""
    path = lambda t: np.array([0.3, 0.3]) if t < 0.5 else np.array([1.7, 0.8])  # noqa: E731
    found = track(path, 120.0, 80)
    assert off(path, found)[:, 0].max() < 0.4e-3
    unknown = [time for time, state in found if state is None and time > 0.1]
    assert unknown == pytest.approx(np.arange(60, 72) / 120.0)


def test_one_measurement_out_of_reach_does_not_end_the_track():
    path, rng, tracker = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), KalmanTracker(POWER)
    far = np.array([1.5, 0.5])
    found = [tracker.update(k / 120.0, [seen(far if k == 20 else path(k / 120.0), rng)]) for k in range(30)]
    assert [k for k, one in enumerate(found) if one is None] == [0, 20]


def test_after_a_contact_two_measurements_within_reach_are_ambiguous():
    """With no velocity known, both are where it can have gone."""
    rng, tracker = np.random.default_rng(1), KalmanTracker(POWER)
    at = lambda x: seen(np.array([x, 0.5]), rng)  # noqa: E731
    for k in range(10):
        tracker.update(k / 120.0, [at(0.5)])
    assert tracker.update(10 / 120.0, [at(0.55)]) is not None
    assert tracker.update(11 / 120.0, [at(0.52), at(0.62)]) is None


def test_times_must_grow():
    tracker = KalmanTracker(POWER)
    tracker.update(1.0, [seen(np.zeros(2), np.random.default_rng(0))])
    with pytest.raises(ValueError, match=r"a picture of 1\.000000 s after one of 1\.000000 s"):
        tracker.update(1.0, [])
