"""An unlisted law is identified from a recording, switched on in the simulator, and used in games."""

import math

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.options.effects_file import effect_values
from puckpilot_env.parameters import make_records
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.effects import unlisted_force, unlisted_window
from puckpilot_env.physics.sliding.slide import slide
from sim2real.diagnose.output.files import write
from sim2real.diagnose.pipeline import diagnose
from sim2real.diagnose.regimes.sliding.forces.as_effect import SWITCHES, effect_parameters
from sim2real.diagnose.regimes.sliding.forces.basis_library import basis_of
from sim2real.diagnose.regimes.sliding.forces.motion import Motion
from sim2real.diagnose.regimes.sliding.forces.searched_forces import Span, Wave
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law, run
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

SIZE = np.array([2.0, 1.0])
VORTEX = Law(vortex=0.06, vortex_x=1.0, vortex_y=0.5, vortex_size=0.3)


SEARCHED = [
    Wave(7.25), Span("push", "t", 10.0, 30.5), Span("brake", "x", 0.4, 1.1), Span("push", "y", -1.0, 0.25),
    Span("brake", "t", 1.5, 3.25, 6.5),
]  # fmt: skip


@pytest.mark.parametrize("family", [*SWITCHES, *(one.name for one in SEARCHED)])
def test_the_simulator_s_force_is_the_family_s(family):
    """The family's columns times coefficients, also at motions outside the data that its knots come from."""
    rng = np.random.default_rng(4)
    n = 200
    motion = Motion(
        np.sort(rng.uniform(0, 60, n)),
        rng.uniform(0, 1, (n, 2)) * SIZE,
        rng.normal(0, 1, (n, 2)),
        np.full(n, np.nan),
        np.zeros(n),
        np.zeros(n),
        SIZE,
        np.linspace(0.1, 2.5, 6),
    )
    columns = basis_of(family)(motion)
    theta = rng.normal(0, 1, columns.shape[2])
    p = make_records(1, effect_parameters(family, motion, theta))[0]
    for k in range(n):
        place, velocity = motion.place[k], motion.velocity[k]
        force = np.zeros(2)
        for effect in (unlisted_force, unlisted_window):
            extra = effect.friction(p, motion.t[k], *place, *(1e-12 * velocity), 0.0)
            force += effect.acceleration(p, motion.t[k], *place, *velocity, 3.0) - extra * motion.along[k]
        assert force == pytest.approx(columns[k] @ theta, abs=1e-9)


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """effects.toml of a diagnosis of half a minute on a table with a vortex."""
    folder = tmp_path_factory.mktemp("vortex")
    make_recording(folder / "table", VORTEX, "launches", 12, 30.0, camera=Camera(noise=0.0006, rate=150.0), dt=5e-5)
    diagnosis = diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None)
    assert [(one.mechanism, one.depends_on) for one in diagnosis.findings] == [("unlisted", ("position",))]
    write(diagnosis, folder / "out")
    return folder / "out" / "effects.toml"


@pytest.mark.slow
def test_pucks_slide_as_on_the_table_with_the_vortex(found):
    """Glides of one second on the corrected simulator at the recorded places have a tenth of the baseline's error."""
    rng = np.random.default_rng(8)
    miss = {"mended": [], "baseline": []}
    records = {"mended": make_records(1, effect_values(found))[0], "baseline": make_records(1)[0]}
    for _ in range(40):
        x, y, speed, heading = rng.uniform(0.6, 1.4), rng.uniform(0.3, 0.7), rng.uniform(0.1, 0.4), rng.uniform(0, 6.3)
        start = (x, y, speed * math.cos(heading), speed * math.sin(heading))
        real = run(VORTEX, start, duration=1.0).end_puck
        for name, p in records.items():
            puck = np.zeros(1, PUCK).view(np.recarray)[0]
            puck.x, puck.y, puck.vx, puck.vy = start
            slide(puck, p, 0.0, 1.0)
            miss[name].append(math.hypot(puck.x - real[0], puck.y - real[1]))
    rms = {name: float(np.sqrt(np.mean(np.square(each)))) for name, each in miss.items()}
    assert rms["baseline"] > 0.005
    assert rms["mended"] < 0.15 * rms["baseline"]


@pytest.mark.slow
def test_players_meet_on_it(found, capsys):
    tables = Tables("match-v0", 1, effects=found)
    assert tables.params["unlisted_kind"][0] == 1.0
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(found), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
