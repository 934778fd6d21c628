"""An unlisted law of the gantry, and friction, are found in a recording and switched on in the simulator."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.batch.motion import mallet_motion
from puckpilot_env.options.effects_file import effect_values
from sim2real.diagnose.output.files import write
from sim2real.diagnose.pipeline import diagnose
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.record import make_recording
from tests.puckpilot_env.physics.reference_play import PERIOD, asked_for, gentle

pytestmark = pytest.mark.slow
STEPS = 12


def effects_of(law: Law, folder: Path) -> Path:
    """The effects.toml of a diagnosis of 40 s of a gantry with the law."""
    make_recording(folder / "table", law, "gantry", 1, 40.0, dt=1e-4)
    write(diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None), folder / "out")
    return folder / "out" / "effects.toml"


def apart(law: Law, values: dict[str, float]) -> float:
    """How far [m], at most, the robot's mallet comes from that of the reference with the law in STEPS steps."""
    tables, rng = Tables("match-v0", 1, seed=3, parameters=values), np.random.default_rng(5)
    motion, plans = [mallet_motion(tables.states)[0]], [[], []]
    for step in range(STEPS):
        actions = gentle(tables, rng)
        for k, plan in enumerate(asked_for(tables, actions)):
            plans[k].append((PERIOD * step, plan))
        tables.step(actions)
        motion.append(mallet_motion(tables.states)[0])
    trace = run(law, None, motion[0][:, :2], plans, STEPS * PERIOD, 2e-5)
    times = np.arange(STEPS + 1) * PERIOD
    seen = np.array([np.interp(times, trace.t, trace.mallets[0][:, c]) for c in (0, 3)]).T
    return float(np.abs(seen - np.array(motion)[:, 0, :2]).max())


@pytest.mark.parametrize(
    "law, switch",
    [
        (Law(rough=0.3, rough_length=0.5), {"drive_kind": 0.0}),
        (Law(motor_friction_left=0.6, motor_friction_right=0.6), dict.fromkeys(
            ("motor_friction_left", "motor_friction_right", "axis_friction_x", "axis_friction_y"), 0.0)),
    ],
)  # fmt: skip
def test_the_mallet_goes_as_on_the_table_with_the_law(law: Law, switch: dict[str, float], tmp_path: Path) -> None:
    found = effects_of(law, tmp_path)
    values = effect_values(found)
    assert apart(law, values) < 0.15 * apart(law, {**values, **switch})


def test_players_meet_on_it(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    found = effects_of(Law(cubic_loss=0.2), tmp_path)
    assert Tables("match-v0", 1, effects=found).params["drive_kind"][0] == 3.0
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(found), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
