"""A profile: written and read again, refused in one line where broken, and loaded where effects and draws are."""

from __future__ import annotations

import json
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.options.profile_file import FittedLaw, Profile, Value, from_content, read_profile, write_profile
from puckpilot_env.options.randomization import Draw

CONSTANTS = {
    "a1": 3.6e-6, "a2": 0.0084, "a3": 0.0648, "b1": -1.7e-6, "b2": -0.0039, "b3": 0.0036, "pulley_radius": 0.0357,
}  # fmt: skip
PROFILE = Profile(
    "gantry", ("a", "log b"), ("c",), "friction", (0.05, 0.1), {"past": 0.02, "count": 80.0}, CONSTANTS,
    (Draw("gantry_spread", "uniform", 0.0, 0.04, "its intervals"),),
    {
        "third_order": FittedLaw("third order", {"c6_x": Value(0.012, 0.011, 0.013, "V s^2")}, {"c": (0.004, 0.009)}),
        "friction": FittedLaw("+ friction", {"friction_x": Value(0.1, -0.2, 0.4, "V", False)}, {"c": (0.002, 0.004)}),
    },
)  # fmt: skip


@pytest.fixture
def path(tmp_path: Path) -> Path:
    return write_profile(tmp_path / "new" / "gantry.toml", PROFILE, ("what it is",))


def test_what_is_written_is_read(path: Path) -> None:
    assert read_profile(path) == PROFILE
    assert path.read_text("utf-8").startswith('# what it is\nformat = "puckpilot-profile/1"\n')
    assert from_content(json.loads(json.dumps(PROFILE.as_dict()))) == PROFILE


def test_a_table_made_with_it_has_its_constants(path: Path) -> None:
    by_effects = Tables("match-v0", 2, effects=path).nominal[0]
    by_parameters = Tables("match-v0", 2, parameters=read_profile(path).parameters).nominal[0]
    for name, value in CONSTANTS.items():
        assert by_effects[name] == by_parameters[name] == value


def test_a_randomized_table_draws_from_its_intervals(path: Path) -> None:
    tables = Tables("match-randomized-v0", 400, seed=1, draws=path)
    found = tables.params["gantry_spread"]
    assert np.all((found >= 0.0) & (found <= 0.04)) and found.max() > 0.039 and found.min() < 0.001
    assert np.all(tables.params["a2"] == CONSTANTS["a2"]) and np.ptp(tables.params["friction"]) > 0.0


FAULTS: dict[str, Callable[[dict[str, Any]], object]] = {
    'format is "x"|expected the line format': lambda all: all.update(format="x"),
    "of is 'mallet'; expected gantry or puck": lambda all: all.update(of="mallet"),
    "unknown parameter 'a9'": lambda all: all["parameters"].update(a9=1.0),
    "parameter 'a2' is 7": lambda all: all["parameters"].update(a2=7),
    "gantry axis x cannot be simulated": lambda all: all["parameters"].update(a1=5e-4),
    "chosen is 'belt'; expected one of third_order, friction": lambda all: all.update(chosen="belt"),
    "times is 3; expected a list": lambda all: all.update(times=3),
    "times is 'soon'; expected a number": lambda all: all.update(times=["soon"]),
    "recordings is 1; expected a text": lambda all: all.update(recordings=[1]),
    "windows.past is 'x'; expected a number": lambda all: all["windows"].update(past="x"),
    "draws.gantry_spread has no low": lambda all: all["draws"]["gantry_spread"].pop("low"),
    "expected low <= value <= high": lambda all: all["laws"]["third_order"]["values"]["c6_x"].update(low=0.0125),
    "determined is None; expected true or false": (
        lambda all: all["laws"]["third_order"]["values"]["c6_x"].pop("determined")
    ),
    "c6_x.unit is None; expected a text": lambda all: all["laws"]["third_order"]["values"]["c6_x"].pop("unit"),
    "laws.third_order.rms.c is 1; expected a list": lambda all: all["laws"]["third_order"]["rms"].update(c=1),
    "unknown key of laws.third_order 'rsm'; did you mean 'rms'": lambda all: all["laws"]["third_order"].update(rsm={}),
    "unknown entry 'law'": lambda all: all.update(law=1),
}


@pytest.mark.parametrize("words", FAULTS)
def test_a_broken_one_is_refused_in_one_line(words: str, path: Path) -> None:
    content = tomllib.loads(path.read_text("utf-8"))
    FAULTS[words](content)
    with pytest.raises(ValueError, match=words) as error:
        from_content(content)
    assert "\n" not in str(error.value)


def test_a_file_that_is_none_is_refused_by_its_path(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text("x = [", encoding="utf-8")
    for name, words in (("x.toml", "not a TOML file"), ("no.toml", "cannot read a profile")):
        with pytest.raises(ValueError, match=words):
            read_profile(tmp_path / name)
