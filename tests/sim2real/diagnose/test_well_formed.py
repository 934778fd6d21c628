"""The format checker finds each fault of a diagnosis, and none in a valid one."""

from __future__ import annotations

import json
from typing import Any

import pytest

from tests.sim2real.diagnose.well_formed import faults

TILT = {
    "regime": "glide", "where": {}, "mechanism": "table_tilt", "also_possible": [], "depends_on": [], "formula": "a",
    "parameters": {"tilt_x": {"value": 0.02, "low": 0.019, "high": 0.021, "unit": "m/s^2"}}, "p_value": 1e-9,
    "heldout": {"before": 1.9, "after": 1.0, "unit": "rms in units of the sensor's noise"},
}  # fmt: skip
RIGHT = {
    "format": "puckpilot-diagnosis/1", "verdict": "missing_physics", "baseline": {"parameters": {}}, "findings": [TILT],
    "heldout": {"before_m": 0.002, "after_m": 0.001, "floor_m": 0.001, "pieces": 9}, "next_recording": "",
}  # fmt: skip


@pytest.mark.parametrize(
    "place, value",
    [
        (("format",), "puckpilot-diagnosis/2"),
        (("verdict",), "surely"),
        (("verdict",), "agrees"),
        (("heldout",), None),
        (("heldout", "pieces"), None),
        (("next_recording",), None),
        (("findings", 0, "regime"), "air"),
        (("findings", 0, "mechanism"), "gremlins"),
        (("findings", 0, "mechanism"), "unlisted"),
        (("findings", 0, "also_possible"), ["gremlins"]),
        (("findings", 0, "depends_on"), ["moon"]),
        (("findings", 0, "p_value"), 2.0),
        (("findings", 0, "heldout"), {}),
        (("findings", 0, "parameters", "tilt_x", "low"), 0.03),
        (("findings", 0, "parameters", "tilt_x", "unit"), ""),
    ],
)
def test_one_fault_is_found(place: tuple[Any, ...], value: Any):
    printed = json.loads(json.dumps(RIGHT))
    assert faults(printed) == []
    part = printed
    for step in place[:-1]:
        part = part[step]
    part[place[-1]] = value
    assert faults(printed)
