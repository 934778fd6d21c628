"""Sizes that recordings state are merged; sizes that none states are noted."""

from __future__ import annotations

import numpy as np
import pytest

from puckpilot_env.parameters import BY_NAME
from sim2real.recording.folder import Recording, Stream
from sim2real.recording.stated import assumptions, together
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.causes import geometry
from tests.sim2real.diagnose.synthetic import META

T = np.arange(3) / 100
BLANK = np.full(3, np.nan)
FRAMES = Stream({"t": T, "puck_x": T, "puck_y": T, "opponent_x": BLANK, "opponent_y": BLANK})
MALLET = Stream({"t": T, "mallet_x": T, "mallet_y": T})
DRIVE = Stream({"t": T, "pwm_left": T, "pwm_right": T})


def stating(name: str, length: float | None, **sections) -> Recording:
    """A recording of a puck that states `length` and the other given sizes."""
    return Recording(name, {**META, "table": {**META["table"], "length_m": length}, **sections}, FRAMES)


def test_a_size_that_one_states_holds_for_all():
    both = together([stating("a", None), stating("b", 2.4, gantry={"supply_V": 19.0})], {})
    assert [geometry(one).length for one in both] == [2.4, 2.4]
    assert [parameters(one)["max_voltage"] for one in both] == [19.0, 19.0]
    assert list(assumptions(both)) == []


def test_a_baseline_states_what_no_recording_does():
    (one,) = together([stating("a", None)], {"length": 2.2, "width": 1.7})
    assert (geometry(one).length, geometry(one).width) == (2.2, META["table"]["width_m"])
    assert "length" not in geometry(one).assumed


@pytest.mark.parametrize("key, values", [("supply_V", (24.0, 19.0)), ("pulley_radius_m", (0.035, 0.03))])
def test_other_gantries_are_other_tables(key, values):
    with pytest.raises(ValueError, match=rf"a states gantry\.{key} .*, b "):
        together([stating(name, None, gantry={key: value}) for name, value in zip("ab", values, strict=True)], {})


def test_a_gantry_measured_anew_is_the_same():
    radii = (0.03568, 0.03569)
    both = together([stating("ab"[k], 2.0, gantry={"pulley_radius_m": radii[k]}) for k in (0, 1)], {})
    assert [parameters(one)["pulley_radius"] for one in both] == [radii[0], radii[0]]


def test_sizes_are_compared_past_a_recording_that_states_none():
    with pytest.raises(ValueError, match=r"b states table\.length_m 2, c 2\.4"):
        together([stating("a", None), stating("b", 2.0), stating("c", 2.4)], {})


@pytest.mark.parametrize(
    "section, key, name, expected",
    [
        ("table", "length_m", "length", f"{BY_NAME['length'].default:g} m"),
        ("puck", "radius_m", "puck_radius", f"{BY_NAME['puck_radius'].default:g} m"),
        ("table", "goal_width_m", "goal_width", "ignored"),
    ],
)
def test_what_nobody_states_is_said(section, key, name, expected):
    one = Recording("a", {**META, section: {**META[section], key: None}}, FRAMES)
    (said,) = assumptions(together([one], {}))
    assert f"{section}.{key} is not stated" in said and expected in said
    assert geometry(one).assumed == {name}


def test_what_was_not_recorded_needs_no_number():
    unknown = {**META, "mallet": {"radius_m": None}}
    assert list(assumptions([Recording("puck alone", unknown, FRAMES)])) == []
    assert "mallet.radius_m" in next(assumptions([Recording("both", unknown, FRAMES, MALLET)]))
    gantry = list(assumptions([Recording("gantry", META, mallet=MALLET, drive=DRIVE)]))
    assert [said.split(" is ")[0] for said in gantry] == ["gantry.supply_V", "gantry.pulley_radius_m"]
