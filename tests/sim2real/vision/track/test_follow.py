"""Following on paths of our own: straight between walls that mirror, blows, and times in which nothing is seen."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from sim2real.vision.track.follow import Estimate, Follower, Sighting

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


def seen(place: np.ndarray, rng: np.random.Generator, sure: bool = True) -> Sighting:
    return Sighting(place + rng.normal(0.0, NOISE, 2), NOISE**2 * np.eye(2), sure)


def follow(path: Path, rate: float, pictures: int, hidden=lambda time: False) -> list[tuple[float, Estimate | None]]:
    rng, follower = np.random.default_rng(0), Follower(POWER)
    times = np.arange(pictures) / rate
    return [(t, follower.see(t, [] if hidden(t) else [seen(path(t), rng)])) for t in times]


def off(path: Path, found: list[tuple[float, Estimate | None]]) -> np.ndarray:
    """Of what is known: error [m], and its square in standard deviations."""
    rows = []
    for time, estimate in found:
        if estimate is not None:
            error = estimate.place - path(time)
            square = error @ np.linalg.solve(estimate.covariance[:2, :2], error)
            rows.append((float(np.linalg.norm(error)), float(square)))
    return np.array(rows)


@pytest.mark.parametrize("seed", range(5))
def test_a_step_is_the_textbooks(seed: int):
    """Predict and correct with matrices (Kalman 1960; white acceleration: Bar-Shalom et al. 2001, 6.2.2)."""
    rng = np.random.default_rng(seed)
    half, error = rng.normal(size=(4, 4)), rng.normal(size=(2, 2))
    before = Estimate(1.0, rng.normal(size=2), rng.normal(size=2), half @ half.T, 3)
    one = Sighting(rng.normal(size=2), error @ error.T, True)
    dt, eye = 0.3, np.eye(2)
    on = np.block([[eye, dt * eye], [0.0 * eye, eye]])
    grown = POWER * np.block([[dt**3 / 3.0 * eye, dt**2 / 2.0 * eye], [dt**2 / 2.0 * eye, dt * eye]])
    state, spread = on @ np.r_[before.place, before.velocity], on @ before.covariance @ on.T + grown
    there = before.after(1.3, POWER)
    np.testing.assert_allclose(np.r_[there.place, there.velocity], state)
    np.testing.assert_allclose(there.covariance, spread)
    look = np.hstack([eye, 0.0 * eye])
    sum_of_both, off = look @ spread @ look.T + one.covariance, one.place - look @ state
    gain = spread @ look.T @ np.linalg.inv(sum_of_both)
    assert there.far(one) == pytest.approx(off @ np.linalg.inv(sum_of_both) @ off)
    after = there.corrected(one)
    np.testing.assert_allclose(np.r_[after.place, after.velocity], state + gain @ off)
    np.testing.assert_allclose(after.covariance, (np.eye(4) - gain @ look) @ spread, atol=1e-12)
    assert (after.time, after.pictures) == (1.3, 4)


@pytest.mark.parametrize("rate", [100.0, 120.0, 200.0])
@pytest.mark.parametrize("velocity", [(0.0, 0.0), (1.3, 0.4), (-4.0, 3.0), (0.3, -9.0)])
def test_between_walls_it_is_known_from_the_second_picture_on_and_within_its_deviations(rate, velocity):
    path = mirrored((0.7, 0.4), velocity)
    found = follow(path, rate, 400)
    assert found[0][1] is None and all(estimate is not None for _, estimate in found[1:])
    far = off(path, found)
    assert far[:, 0].max() < 0.4e-3 and 0.01 < (far[:, 1] > 5.99).mean() < 0.1 and (far[:, 1] > 16.0).mean() < 0.01


def test_on_a_free_way_no_sighting_is_taken_for_a_blow():
    """A blow would leave the velocity unknown; of 3,000 sightings one lies farther off than four deviations."""
    path = lambda t: np.array([0.1, 0.1]) + t * np.array([0.5, 0.2])  # noqa: E731
    found = follow(path, 120.0, 400)
    assert max(estimate.covariance[2, 2] for _, estimate in found[5:] if estimate is not None) < 0.1**2


def test_the_velocity_is_that_of_the_path():
    last = follow(mirrored((0.3, 0.3), (1.0, 0.5)), 120.0, 60)[-1][1]
    assert last is not None
    deviation = float(np.sqrt(last.covariance[2, 2]))
    assert last.velocity == pytest.approx((1.0, 0.5), abs=4.0 * deviation) and deviation < 0.03


def test_after_a_blow_it_goes_on_at_once_and_owns_that_its_velocity_is_not_known():
    blow = 0.5
    before, after = mirrored((0.5, 0.5), (-1.0, 0.0)), mirrored((0.1, 0.5), (6.0, 1.0))
    path = lambda t: before(t) if t < blow else before(blow) + after(t - blow) - after(0.0)  # noqa: E731
    found = follow(path, 120.0, 90)
    assert off(path, found)[:, 0].max() < 0.4e-3 and all(estimate is not None for _, estimate in found[1:])
    first = next(estimate for time, estimate in found if estimate is not None and time > blow + 1e-9)
    assert np.sqrt(first.covariance[2, 2]) > 1.0
    last = found[-1][1]
    assert last is not None
    assert last.velocity == pytest.approx((6.0, 1.0), abs=0.1)


@pytest.mark.parametrize("rate", [100.0, 200.0])
@pytest.mark.parametrize("hidden", [0.1, 0.25, 0.5])
@pytest.mark.parametrize("struck", [False, True])
def test_under_the_gantry_it_is_not_known_and_after_it_soon_is(rate, hidden, struck):
    """Two pictures after it comes out it is known again, whether it was struck in there or not."""
    begin, end = 0.3, 0.3 + hidden
    free, away = mirrored((0.9, 0.3), (-1.5, 0.3)), mirrored((0.9, 0.3), (5.0, 1.0))
    turn = 0.5 * (begin + end)
    path = lambda t: free(t) if t < turn or not struck else free(turn) + away(t - turn) - away(0.0)  # noqa: E731
    found = follow(path, rate, int((end + 0.1) * rate), lambda t: begin <= t < end)
    assert all(estimate is None for time, estimate in found if begin <= time < end - 1e-9)
    assert all(estimate is not None for time, estimate in found if time >= end + 1.0 / rate)
    assert off(path, found)[:, 0].max() < 0.4e-3


@pytest.mark.parametrize("rate", [100.0, 120.0, 200.0])
@pytest.mark.parametrize("speed", [6.0, 9.0, 14.0])
@pytest.mark.parametrize("hidden", [0.015, 0.03, 0.045])
def test_turned_back_under_the_gantry_it_is_known_from_the_second_picture_on(rate, speed, hidden):
    begin, end = 0.05, 0.05 + hidden
    path = lambda t: np.array([1.2 - speed * (t if t < begin else 2.0 * begin - t), 0.5])  # noqa: E731
    found = follow(path, rate, int((end + 0.1) * rate), lambda t: begin < t < end)
    assert all(estimate is not None for time, estimate in found if time >= end + 1.0 / rate)
    assert off(path, found)[:, 0].max() < 0.4e-3


@pytest.mark.parametrize("before", [0.3, 0.35])
def test_one_false_sighting_while_it_is_hidden_is_not_believed(before):
    """Not even if it was struck in the last picture that showed it, so that nobody knows its velocity."""
    rng, follower = np.random.default_rng(0), Follower(POWER)
    for k in range(30):
        follower.see(k / 120.0, [seen(np.array([0.3 if k == 29 else before, 0.5]), rng)])
    assert all(follower.see(k / 120.0, []) is None for k in range(30, 35))
    assert follower.see(35 / 120.0, [seen(np.array([0.7, 0.5]), rng)]) is None
    assert follower.see(36 / 120.0, []) is None
    for k in range(37, 60):
        last = follower.see(k / 120.0, [seen(np.array([0.3, 0.5]), rng)])
        assert (last is not None) == (k > 37)


def test_a_false_first_sighting_costs_two_pictures():
    path, rng, follower = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), Follower(POWER)
    assert follower.see(0.0, [seen(np.array([1.5, 0.5]), rng)]) is None
    found = [follower.see(k / 120.0, [seen(path(k / 120.0), rng)]) for k in (1, 2)]
    assert found[0] is None and found[1] is not None


def test_a_false_sighting_beside_it_is_not_followed():
    path, rng, follower = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), Follower(POWER)
    still = np.array([0.62, 0.46])  # its way leads past it
    found = []
    for k in range(100):
        places = [path(k / 120.0)] if k < 3 else [still, path(k / 120.0)]
        found.append((k / 120.0, follower.see(k / 120.0, [seen(place, rng) for place in places])))
    assert off(path, found)[:, 0].max() < 0.4e-3 and len(off(path, found)) == 99


def test_of_two_that_it_could_be_neither_is_it():
    rng, follower = np.random.default_rng(0), Follower(POWER)
    for k in range(30):
        both = [seen(np.array([0.5, 0.5]), rng), seen(np.array([1.5, 0.5]), rng)]
        assert follower.see(k / 120.0, both) is None


def test_what_could_be_something_else_begins_no_path_but_goes_on_with_one():
    rng, follower = np.random.default_rng(0), Follower(POWER)
    place = np.array([0.5, 0.5])
    assert all(follower.see(k / 120.0, [seen(place, rng, sure=False)]) is None for k in range(10))
    for k in range(10, 20):
        follower.see(k / 120.0, [seen(place, rng)])
    assert follower.see(20 / 120.0, [seen(place, rng, sure=False)]) is not None
    assert follower.see(21 / 120.0, [seen(place + 0.3, rng, sure=False)]) is None


@pytest.mark.parametrize("rate", [100.0, 120.0])
def test_what_could_be_something_else_is_no_second_sighting(rate):
    rng, follower = np.random.default_rng(0), Follower(POWER)
    follower.see(0.0, [seen(np.array([0.5, 0.5]), rng)])
    assert follower.see(1.0 / rate, [seen(np.array([0.505, 0.5]), rng, sure=False)]) is None


def test_moved_by_hand_it_is_found_again():
    """It jumps 1.5 m, farther than it can fly in less than 0.1 s: not known until then and in one picture more."""
    path = lambda t: np.array([0.3, 0.3]) if t < 0.5 else np.array([1.7, 0.8])  # noqa: E731
    found = follow(path, 120.0, 80)
    assert off(path, found)[:, 0].max() < 0.4e-3
    unknown = [time for time, estimate in found if estimate is None and time > 0.1]
    assert unknown == pytest.approx(np.arange(60, 72) / 120.0)


def test_seen_in_one_picture_where_it_cannot_be_it_is_still_where_it_was():
    path, rng, follower = mirrored((0.3, 0.3), (2.0, 1.0)), np.random.default_rng(1), Follower(POWER)
    far = np.array([1.5, 0.5])
    found = [follower.see(k / 120.0, [seen(far if k == 20 else path(k / 120.0), rng)]) for k in range(30)]
    assert [k for k, one in enumerate(found) if one is None] == [0, 20]


def test_just_struck_and_seen_in_two_places_neither_is_it():
    """With no velocity known, both are where it can have gone."""
    rng, follower = np.random.default_rng(1), Follower(POWER)
    at = lambda x: seen(np.array([x, 0.5]), rng)  # noqa: E731
    for k in range(10):
        follower.see(k / 120.0, [at(0.5)])
    assert follower.see(10 / 120.0, [at(0.55)]) is not None
    assert follower.see(11 / 120.0, [at(0.52), at(0.62)]) is None


def test_times_must_grow():
    follower = Follower(POWER)
    follower.see(1.0, [seen(np.zeros(2), np.random.default_rng(0))])
    with pytest.raises(ValueError, match=r"a picture of 1\.000000 s after one of 1\.000000 s"):
        follower.see(1.0, [])
