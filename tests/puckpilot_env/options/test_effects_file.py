"""Effects by name or from a file: what they come to, and what is refused, in one line."""

from __future__ import annotations

import tomllib
from pathlib import Path

import pytest

from puckpilot_env.options.effects_file import described, effect_values

GOOD = """
format = "puckpilot-effects/1"

[parameters]
friction = 0.09

[effects.table_tilt]
tilt_x = 0.02

[effects.wall_friction_spin]
mu = 0.11
"""


def write(folder: Path, text: str) -> Path:
    path = folder / "effects.toml"
    path.write_text(text, encoding="utf-8")
    return path


def test_a_file_comes_to_the_simulator_s_names(tmp_path: Path) -> None:
    assert effect_values(write(tmp_path, GOOD)) == {"friction": 0.09, "tilt_x": 0.02, "wall_mu": 0.11}
    assert effect_values(str(write(tmp_path, 'format = "puckpilot-effects/1"'))) == {}


def test_a_mapping_does_too() -> None:
    assert effect_values({"friction_patch": {"x": 1, "extra": -0.1}}) == {"patch_x": 1.0, "patch_extra": -0.1}
    assert effect_values({}) == effect_values(None) == {}


def test_what_a_toml_reader_makes_of_a_file_does_too() -> None:
    assert effect_values(tomllib.loads(GOOD)) == {"friction": 0.09, "tilt_x": 0.02, "wall_mu": 0.11}
    with pytest.raises(ValueError, match=r"^format is 'other'; expected"):
        effect_values({**tomllib.loads(GOOD), "format": "other"})


def test_a_file_is_told_in_lines(tmp_path: Path) -> None:
    text = GOOD + "\n[effects.side_force]\ncoefficient = 0.0\n# not in the simulator: clock_drift of the sensing\n"
    assert described(write(tmp_path, text)) == [
        "effect on: table_tilt (tilt_x 0.02)",
        "effect on: wall_friction_spin (mu 0.11)",
        "in place of the defaults: friction 0.09",
        "not switched on: clock_drift of the sensing",
    ]
    assert "in place of the defaults: friction 0.09" not in described(write(tmp_path, GOOD), apart_from=["friction"])
    assert described(write(tmp_path, 'format = "puckpilot-effects/1"')) == ["no effect is on"]


@pytest.mark.parametrize(
    "old, new, expected",
    [
        ("puckpilot-effects/1", "puckpilot-effects/2", "format is 'puckpilot-effects/2'; expected"),
        ('format = "puckpilot-effects/1"', "", "there is no line with its format; expected the line"),
        ("[parameters]", "[parameter]", "unknown entry 'parameter'; did you mean 'parameters'?"),
        ("friction =", "frictoin =", "unknown parameter 'frictoin'; did you mean 'friction'?"),
        ("0.09", "9.0", "parameter 'friction' is 9.0; expected a number in [0, 5] m/s^2"),
        ("0.09", '"0.09"', "parameter 'friction' is '0.09'; expected a number"),
        ("0.09", "true", "parameter 'friction' is True; expected a number"),
        ("0.02", "nan", "parameter 'tilt_x' is nan; expected a number in"),
        ("0.02", "[0.02]", "parameter 'tilt_x' is [0.02]; expected a number in"),
        ("table_tilt", "table_tlit", "unknown effect 'table_tlit'; did you mean 'table_tilt'?"),
        ("tilt_x =", "tilt_z =", "unknown number of table_tilt 'tilt_z'; did you mean 'tilt_"),
        (
            "[effects.table_tilt]\ntilt_x = 0.02",
            "[effects]\ntable_tilt = 3",
            "effects.table_tilt is 3; expected numbers",
        ),
        ("mu = 0.11", "mu = ", "line"),
    ],
)
def test_what_cannot_be_is_refused_in_one_line(tmp_path: Path, old: str, new: str, expected: str) -> None:
    assert old in GOOD
    path = write(tmp_path, GOOD.replace(old, new))
    with pytest.raises(ValueError) as refusal:
        effect_values(path)
    assert str(refusal.value).startswith(f"{path}: ") and expected in str(refusal.value)
    assert "\n" not in str(refusal.value)


@pytest.mark.parametrize("how", ["missing", "folder", "picture"])
def test_what_is_no_such_file_is_refused(tmp_path: Path, how: str) -> None:
    path = tmp_path if how == "folder" else tmp_path / "file.toml"
    if how == "picture":
        path.write_bytes(b"\x89PNG\r\n\xff\xfe")
    with pytest.raises(ValueError, match=str(path)) as refusal:
        effect_values(path)
    assert "\n" not in str(refusal.value)


def test_a_mapping_is_as_strict() -> None:
    with pytest.raises(ValueError, match=r"^unknown effect 'tilt'; "):
        effect_values({"tilt": {"tilt_x": 0.1}})
    with pytest.raises(ValueError, match=r"^parameter 'tilt_x' is 5; expected a number in \[-0.2, 0.2\] m/s\^2$"):
        effect_values({"table_tilt": {"tilt_x": 5}})
    with pytest.raises(ValueError, match=r"^effects.table_tilt has no numbers; expected some of tilt_x, tilt_y$"):
        effect_values({"table_tilt": {}})


def test_an_effect_that_no_table_can_have_is_refused_by_name() -> None:
    with pytest.raises(ValueError, match=r"^no table can be given clock_drift: .*one clock.*; leave it out$"):
        effect_values({"clock_drift": {"ppm": 0.01}})
    assert list(effect_values({"clock_drift": {"ppm": 0.0}}).values()) == [0.0]
