"""An unlisted law of the gantry, and friction, are found in a recording and switched on in the simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.options.effects_file import effect_values
from puckpilot_env.physics.effects import motor_friction
from puckpilot_env.physics.effects.unlisted_drive import LOSS_BY_PLACE
from sim2real.diagnose.output.files import write
from sim2real.diagnose.pipeline import diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.record import make_recording
from tests.puckpilot_env.physics.reference_play import PERIOD, played

pytestmark = pytest.mark.slow
STEPS = 12


def effects_of(law: Law, folder: Path) -> Path:
    """The effects.toml of a diagnosis of 20 s of a gantry with the law."""
    make_recording(folder / "table", law, "gantry", 1, 20.0, dt=1e-4)
    write(diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None), folder / "out")
    return folder / "out" / "effects.toml"


def largest_error(law: Law, values: dict[str, float]) -> float:
    """How far [m], at most, the robot's mallet comes from that of the reference with the law in STEPS steps."""
    motion, plans = played(Tables("match-v0", 1, seed=3, parameters=values), STEPS)
    trace = run(law, None, motion[0][:, :2], plans, STEPS * PERIOD, 2e-5)
    times = np.arange(STEPS + 1) * PERIOD
    seen = np.array([np.interp(times, trace.t, trace.mallets[0][:, c]) for c in (0, 3)]).T
    return float(np.abs(seen - motion[:, 0, :2]).max())


ROUGH = Law(rough=0.3, rough_length=0.5)
DRY = Law(motor_friction_left=0.6, motor_friction_right=0.5, axis_friction_y=0.3)
FRICTION = {name: getattr(DRY, name) for name in motor_friction.EFFECT.row_names}


@pytest.fixture(scope="module")
def rough(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return effects_of(ROUGH, tmp_path_factory.mktemp("rough"))


def test_the_mallet_goes_as_on_the_table_with_an_unlisted_law(rough: Path) -> None:
    values = effect_values(rough)
    assert largest_error(ROUGH, values) < 0.1 * largest_error(ROUGH, {**values, "drive_kind": 0.0})


def test_the_mallet_goes_as_on_the_table_with_friction(tmp_path: Path) -> None:
    values = effect_values(effects_of(DRY, tmp_path))
    assert {name: values[name] for name in FRICTION} == pytest.approx(FRICTION, abs=0.01)
    assert largest_error(DRY, values) < 0.01 * largest_error(DRY, {**values, **dict.fromkeys(FRICTION, 0.0)})


def test_players_meet_on_it(rough: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert Tables("match-v0", 1, effects=rough).params["drive_kind"][0] == LOSS_BY_PLACE
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(rough), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
