"""The fit finds known constants, its intervals hold them as often as they say, and a number without use is told."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.identify.gantry.fit import Fit, errors, fit, rms
from sim2real.identify.gantry.law import STEPS, Law, as_shipped
from sim2real.identify.gantry.logs import Piece, read_log, whole
from tests.places import UBC
from tests.sim2real.identify.gantry.simulated import KNOWN, RADIUS, SUPPLY, log


def with_friction(radius: float = RADIUS) -> Law:
    return as_shipped(radius).after(STEPS[0]).after(STEPS[1])


def piece(seed: int, seconds: float, **how: float) -> Piece:
    return whole(read_log(log(seed, seconds, **how), SUPPLY))


def coverage(logs: int, seconds: float, repeats: int) -> float:
    """The share of 95 % intervals that hold the constant."""
    held = []
    for repeat in range(repeats):
        found = fit(with_friction(), [piece(1000 * repeat + k, seconds) for k in range(logs)])
        intervals = {name: found.interval(name) for name in found.law.free}
        held += [one.low <= KNOWN[name] <= one.high for name, one in intervals.items()]
    return float(np.mean(held))


@pytest.mark.long
def test_intervals_of_one_log_hold_the_constants() -> None:
    assert 0.88 <= coverage(1, 8.0, 12) <= 1.0  # 96 intervals, of which some 30 are independent


@pytest.mark.slow
def test_intervals_of_several_logs_hold_the_constants_too() -> None:
    assert 0.9 <= coverage(5, 4.0, 6) <= 1.0


@pytest.mark.slow
def test_without_noise_the_constants_themselves_come_back() -> None:
    found = fit(with_friction(), [piece(5, 6.0, noise=0.0, push=0.0)])
    for name in found.law.free:  # rows of 0.85 ms are coarse beside the friction's build-up
        assert found.law.values[name] == pytest.approx(KNOWN[name], rel=0.02, abs=0.02), name


def test_a_number_is_determined_only_by_an_interval_that_says_something() -> None:
    law = as_shipped(RADIUS).after(STEPS[0]).at({"friction_x": 0.3, "friction_y": 0.3, "c6_x": 0.01, "c7_x": 0.05})
    std = dict.fromkeys(law.free, 1e-4) | {"friction_x": 0.1, "friction_y": 0.2, "c6_x": 0.001, "c7_x": 0.02}
    found = Fit(law, np.diag([std[name] ** 2 for name in law.free]), 2.0)
    told = {name: found.interval(name).determined for name in ("friction_x", "friction_y", "c6_x", "c7_x")}
    assert told == {"friction_x": True, "friction_y": False, "c6_x": True, "c7_x": False}
    assert (found.interval("friction_x").low, found.interval("friction_x").high) == pytest.approx((0.1, 0.5))
    assert found.half({"c6_x": 0.5, "c7_x": 0.5}) == pytest.approx(2.0 * np.hypot(0.0005, 0.01))


def test_a_law_that_cannot_be_simulated_predicts_nothing() -> None:
    one = piece(6, 3.0)
    assert np.isfinite(errors(as_shipped(RADIUS), one.log, one.fit)).all()
    assert np.isnan(errors(as_shipped(RADIUS).at({"lag": 100.0}), one.log, one.fit)).all()


@pytest.mark.slow
def test_a_log_that_differs_widens_the_intervals_of_all() -> None:
    alike = fit(as_shipped(RADIUS), [piece(k, 3.0, push=0.05) for k in range(4)])
    unlike = fit(as_shipped(RADIUS), [piece(k, 3.0, push=0.05, c6_x=0.011 + 0.001 * k) for k in range(4)])
    assert unlike.half({"c6_x": 1.0}) > 3.0 * alike.half({"c6_x": 1.0})


@pytest.mark.slow
@pytest.mark.skipif(not UBC.exists(), reason="the shared recordings are not here")
def test_real_logs_that_were_not_fitted_are_predicted_within_the_bars() -> None:
    from sim2real.recording.folder import read_recording

    fitted, others = (
        [whole(read_log(read_recording(UBC / f"gantry_supercap_{name}"), SUPPLY)) for name in names]
        for names in (("10V", "MaxV", "MaxV_3"), ("10V_2", "MaxV_2"))
    )
    law = with_friction()
    for step in STEPS[2:5]:  # motors of unequal strength, the belt, weaker braking
        law = law.after(step)
    found = fit(law, fitted)
    slow, fast = (1e3 * rms(found.law, one)[1] for one in others)
    assert slow <= 3.6 and fast <= 5.0  # mm, 100 ms ahead
    assert 1e3 * rms(as_shipped(RADIUS), others[1])[1] > 35.0
    assert found.interval("friction_y").determined and errors(law, others[0].log, others[0].judge).shape[1:] == (4, 2)
