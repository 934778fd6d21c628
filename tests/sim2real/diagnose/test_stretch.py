"""A grain of friction that an unknown stretch of the camera's map may be is not told."""

import pytest

from sim2real.diagnose.finding import Account, Estimate, Finding
from sim2real.diagnose.stretch import without_stretch


def _finding(regime: str, mechanism: str, **numbers: float) -> Finding:
    sizes = {name: Estimate(value, value, value, "1") for name, value in numbers.items()}
    return Finding(regime, mechanism, (), ("heading",), "", sizes, 1e-9, 0.002, 0.001, {}, {})


def _account(regime: str, *findings: Finding) -> Account:
    return Account(regime, findings, {}, False, None)


@pytest.mark.parametrize(
    "scales, grain, kept",
    [
        ({"scale_y": 0.019}, -0.008, False),  # x may be 1.6 % off: nobody saw its ends
        ({"scale_x": 0.019, "scale_y": 0.0}, -0.008, True),
        ({"scale_y": 0.019}, -0.08, True),  # no camera is 16 % off
        ({}, -0.008, True),
    ],
)
def test_a_grain_is_told_unless_a_stretch_may_be_it(scales, grain, kept):
    found = _account("glide", _finding("glide", "friction_anisotropy", grain=grain), _finding("glide", "table_tilt"))
    sensing = _account("sensing", *([_finding("sensing", "scale_error", **scales)] if scales else []))
    told = without_stretch(found, sensing)
    assert [one.mechanism for one in told.findings] == ["friction_anisotropy"] * kept + ["table_tilt"]
    assert bool(told.doubt) != kept
