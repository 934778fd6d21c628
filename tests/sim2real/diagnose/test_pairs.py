"""Pairs of effects of which neither explains much without the other, as drawn in studies that missed them."""

from pathlib import Path

import numpy as np
import pytest

from sim2real.diagnose.pipeline import diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table.cases import draw_case
from sim2real.study.independent_table.recorder.record import make_recording


@pytest.mark.slow
@pytest.mark.parametrize(
    ("number", "names"),
    [
        (20, ["tangential_restitution", "wall_to_wall_restitution"]),
        pytest.param(44, ["motor_deadband", "voltage_sag"], marks=pytest.mark.long),
    ],
)
def test_both_are_named(tmp_path: Path, number: int, names: list[str]) -> None:
    case = draw_case(522, number, "two", None)
    assert sorted(case.truth["mechanisms"]) == names
    draw = int(np.random.SeedSequence([522, number, 0]).generate_state(1)[0])
    make_recording(
        tmp_path / "seen", case.law, case.scenario, draw, 60.0, case.camera,
        encoder_noise=case.encoder_noise, hand=case.hand, dt=1e-4,
    )  # fmt: skip
    found = diagnose([read_recording(tmp_path / "seen")], [], {}, lambda stage, share: None)
    assert sorted(one.mechanism for one in found.findings) == names
