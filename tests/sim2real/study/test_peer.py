"""PySINDy as the comparison method: it finds a strong effect in clean data and writes a diagnosis."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim2real.study import peer
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

CLEAN = Camera(noise=0.00002, jitter=0.0)


def ask(tmp_path: Path, law: Law) -> dict:
    make_recording(tmp_path / "a", law, "launches", 3, 40.0, CLEAN, dt=1e-4)
    assert peer.main(["diagnose", str(tmp_path / "a"), "--out", str(tmp_path / "out")]) == 0
    return json.loads((tmp_path / "out" / "diagnosis.json").read_text())


def test_it_finds_a_strong_effect_in_clean_data(tmp_path: Path):
    found = ask(tmp_path, Law(side_force=0.3))
    forces = [one for one in found["findings"] if one["mechanism"] == "side_force"]
    assert found["verdict"] == "missing_physics" and len(forces) == 1
    coefficient = forces[0]["parameters"]["coefficient"]
    assert coefficient["value"] == pytest.approx(0.3, rel=0.05)
    assert coefficient["low"] <= coefficient["value"] <= coefficient["high"]


def test_the_library_holds_the_laws():
    """Along +x at 2 m/s, 0.3 m and 0.1 m from the middle of a 2 m by 1 m table, at t = 5 s."""
    rows = np.array([[5.0, 1.3, 0.6, 2.0, 0.0, 0.0, 0.0]])
    terms = peer.library(rows, 2.0, 1.0)[:, : len(peer.TERMS)].T
    expected = [
        (-1, 0), (-4, 0), (1, 0), (0, 1), (-0.3, 0), (0, -0.1), (-0.1, -0.3), (-2, 0), (-5, 0), (-1, 0), (0, 2),
    ]  # fmt: skip
    assert terms == pytest.approx(np.array(expected, dtype=float), abs=1e-12)


def test_it_is_asked_about_gliding_alone():
    glide = {"scenario": "launches", "regimes": ["glide"]}
    assert peer.can_be_asked(glide) and peer.can_be_asked({"scenario": "posts", "regimes": []})
    assert not peer.can_be_asked({**glide, "regimes": ["wall"]})
    assert not peer.can_be_asked({**glide, "scenario": "rally"})
