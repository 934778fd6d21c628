"""The campaign of damaged frames, smaller than `make -C firmware campaign`, and a while of fuzzing."""

from __future__ import annotations

import json
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.firmware.core.host_core import make


def test_one_bad_byte_costs_two_frames_and_nothing_false_gets_through(tmp_path: Path):
    make(f"BUILD={tmp_path}", f"{tmp_path}/campaign")
    expected = subprocess.run([tmp_path / "campaign", "10000", "300000"], capture_output=True, text=True, check=True)
    found = json.loads(expected.stdout)
    for way in ("flipped", "lost", "inserted"):
        assert found[way]["trials"] == 10000 and found[way]["false"] == 0
        assert 1 <= found[way]["most_lost"] <= 2 and found[way]["mean_lost"] > 0.9
    assert found["corrupt"] == {"frames": 300000, "false": 0}


@pytest.mark.slow
def test_fuzzing_finds_nothing(tmp_path: Path):
    """The whole: `make -C firmware fuzz SECONDS=600`."""
    if not shutil.which("clang") or not shutil.which("unzip"):
        pytest.skip("clang or unzip is not installed: the core is not fuzzed here")
    expected = make("fuzz", f"BUILD={tmp_path}", "SECONDS=5").split()
    assert "ERROR:" not in expected and expected.count("Done") == 2
    runs = [int(expected[at + 1]) for at, word in enumerate(expected) if word == "stat::number_of_executed_units:"]
    assert len(runs) == 2 and runs[0] > 10_000 and runs[1] > 100
