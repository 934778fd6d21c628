"""Presets with impossible values are refused in one line before training starts."""

from __future__ import annotations

from pathlib import Path

import pytest

from agents.training.preset import FOLDER, find_preset, preset_names, read_preset

FAST = (FOLDER / "fast.toml").read_text()


@pytest.mark.parametrize("name", preset_names())
def test_shipped_presets_are_read(name: str) -> None:
    assert find_preset(name).hidden


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("tables", "1" + "0" * 400, r"tables is 1000.* \.\.\.; expected a whole number from 1 to 65,536"),
        ("round", "1000000000", "round is 1000000000; expected a whole number from 1 to 10,000"),
        ("steps", "true", "steps is True; expected a whole number from 1 to 10,000"),
        ("hidden", "[]", "hidden has 0 layers; expected 1 to 8"),
        ("hidden", "[1000000]", "hidden is 1000000; expected a whole number from 1 to 4,096"),
        ("learning_rate", "1e300", r"learning_rate is 1e\+300; expected a number from 0 to 1"),
        ("learning_rate", "1" + "0" * 400, "learning_rate is .*; expected a number from 0 to 1"),
        ("learning_rate", "true", "learning_rate is True; expected a number from 0 to 1"),
        ("num_mini_batches", "1000000", "num_mini_batches is 1000000; expected a whole number from 1 to 4,096"),
        ("num_learning_epochs", "1000000", "num_learning_epochs is 1000000; expected a whole number from 1 to 10,000"),
    ],
)
def test_excessive_values_are_refused(key: str, value: str, message: str) -> None:
    lines = [f"{key} = {value}" if line.split(" ")[0] == key else line for line in FAST.splitlines()]
    assert "\n".join(lines) != FAST.rstrip()
    with pytest.raises(ValueError, match=f"^preset odd: {message}$"):
        read_preset("\n".join(lines), "odd")


def test_more_mini_batches_than_samples_are_refused() -> None:
    lines = [
        {"tables": "tables = 4", "steps": "steps = 2", "num_mini_batches": "num_mini_batches = 9"}.get(
            line.split(" ")[0], line
        )
        for line in FAST.splitlines()
    ]
    with pytest.raises(ValueError, match=r"num_mini_batches is 9; expected at most tables x steps = 8$"):
        read_preset("\n".join(lines), "odd")


def test_a_device_and_deep_nesting_are_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"^preset /dev/zero: is a device or a pipe; expected a file$"):
        find_preset("/dev/zero")
    (tmp_path / "deep.toml").write_text("a = " + "[" * 100_000)
    with pytest.raises(ValueError, match=r"^preset .*deep.toml: tables or lists nest too deep"):
        find_preset(str(tmp_path / "deep.toml"))
