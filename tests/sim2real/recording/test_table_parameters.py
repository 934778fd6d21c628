"""The simulator's parameters from a file: a baseline, and files written by a diagnosis."""

from pathlib import Path

import pytest

from puckpilot import main
from sim2real.recording.table_parameters import read_baseline

WRITTEN = 'format = "puckpilot-effects/1"\n\n[parameters]\nfriction = 0.09\n'


def _file(folder: Path, text: str) -> Path:
    path = folder / "b.toml"
    path.write_text(text)
    return path


def test_a_baseline_is_lines_of_numbers_or_a_diagnosis_s_file_without_effects(tmp_path):
    assert read_baseline(_file(tmp_path, "friction = 0.1\ndrag = 0.2")) == {"friction": 0.1, "drag": 0.2}
    assert read_baseline(_file(tmp_path, WRITTEN)) == {"friction": 0.09}


@pytest.mark.parametrize(
    "text, expected",
    [
        (
            WRITTEN + "[effects.table_tilt]\ntilt_x = 0.02\n",
            r"contains effects \(table_tilt\).*\[parameters\] alone.*match",
        ),
        ("friction", "not a TOML file"),
        ("frictoin = 0.1", "did you mean 'friction'"),
        ("friction = true", "parameter 'friction' is True; expected a number"),
        ("friction = 1" + "0" * 400, r"parameter 'friction' is 1000.*; expected a number in \[0, 5\] m/s\^2"),
        ('format = "puckpilot-effects/1"\nparameters = 3', "parameters is 3; expected numbers by name"),
        ('format = "puckpilot-effects/1"\neffects = 3', "effects is 3; expected numbers by name"),
        ('format = "puckpilot-draws/1"', r"contains ranges to draw from.*\[parameters\] alone.*--draws"),
        ("a = " + "[" * 100_000, "nest too deep"),
    ],
)
def test_what_is_no_baseline_is_refused_with_what_to_do(tmp_path, text, expected):
    with pytest.raises(ValueError, match=expected) as refusal:
        read_baseline(_file(tmp_path, text))
    assert "\n" not in str(refusal.value)


def test_a_baseline_that_is_not_there_is_an_input_and_no_place_to_write(tmp_path, capsys):
    assert main(["diagnose", str(tmp_path), "--baseline", str(tmp_path / "none.toml")]) == 2
    error = capsys.readouterr().err
    assert "cannot read the baseline" in error and "another place" not in error and error.count("\n") == 1
