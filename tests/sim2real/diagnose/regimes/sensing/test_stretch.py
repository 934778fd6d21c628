"""An anisotropy of friction is not named where an undetermined stretch of the camera's map explains it."""

import pytest

from sim2real.diagnose.regimes.sensing.stretch import without_stretch
from sim2real.diagnose.result.result import Estimate, Finding, RegimeResult


def _finding(regime: str, mechanism: str, **numbers: float) -> Finding:
    sizes = {name: Estimate(value, value, value, "1") for name, value in numbers.items()}
    return Finding(regime, mechanism, (), ("heading",), "", sizes, 1e-9, 0.002, 0.001, {}, {})


def _result(regime: str, *findings: Finding) -> RegimeResult:
    return RegimeResult(regime, findings, {}, False, None)


@pytest.mark.parametrize(
    "scales, grain, kept",
    [
        ({"scale_y": 0.019}, -0.008, False),  # x may be 1.6 % off: its walls were not touched
        ({"scale_x": 0.019, "scale_y": 0.0}, -0.008, True),
        ({"scale_y": 0.019}, -0.08, True),  # no camera is 16 % off
        ({}, -0.008, True),
    ],
)
def test_an_anisotropy_is_named_unless_a_stretch_explains_it(scales, grain, kept):
    found = _result("glide", _finding("glide", "friction_anisotropy", grain=grain), _finding("glide", "table_tilt"))
    sensing = _result("sensing", *([_finding("sensing", "scale_error", **scales)] if scales else []))
    mended = without_stretch(found, sensing)
    assert [one.mechanism for one in mended.findings] == ["friction_anisotropy"] * kept + ["table_tilt"]
    assert bool(mended.doubt) != kept
