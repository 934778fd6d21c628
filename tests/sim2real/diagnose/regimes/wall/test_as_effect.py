"""An unlisted law of the walls is identified from a recording, switched on in the simulator, and used in games."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.options.effects_file import described, effect_values
from puckpilot_env.parameters import TABLE, make_records
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.contacts import bounce
from puckpilot_env.physics.contacts.rebound import rebound
from sim2real.diagnose.engine.law import Law as Candidate
from sim2real.diagnose.output.effects_toml import effects_toml
from sim2real.diagnose.output.files import write
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.diagnose.regimes.contact.candidates import COMPONENTS
from sim2real.diagnose.regimes.wall.as_effect import EFFECT_TABLES, effect_parameters
from sim2real.diagnose.regimes.wall.basis_library import BASIS_LIBRARY, SINGLE_WAVES, added_shares
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.stretch import Stretch
from sim2real.diagnose.result.result import Finding, RegimeResult
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.physics.bounce import off_wall
from sim2real.study.independent_table.physics.puck import VX, VY
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

SIZE, RADIUS = (2.0, 1.0), 0.0309
NORMALS = {"x0": (1.0, 0.0), "x1": (-1.0, 0.0), "y0": (0.0, 1.0), "y1": (0.0, -1.0)}
WARMING = Law(wall_warming=-0.003, wall_restitution=0.85)
WAVE = Law(wall_wave=0.07, wall_wave_length=0.61, wall_restitution=0.8)
EACH = [name for name in EFFECT_TABLES if name not in list(SINGLE_WAVES)[1:]]  # one wave represents all


def place_at(wall: str, rng: np.random.Generator) -> np.ndarray:
    """A place (2,) [m] of a puck at a wall, clear of the goals."""
    axis, far = "xy".index(wall[0]), wall[1] == "1"
    place = np.array([rng.uniform(0.1, SIZE[0] - 0.1), rng.choice([0.1, 0.9]) + rng.uniform(-0.06, 0.06)])
    place[axis] = SIZE[axis] - RADIUS if far else RADIUS
    return place


def random_contacts(count: int) -> WallContacts:
    """Contacts with all walls and posts."""
    rng = np.random.default_rng(2)
    walls = rng.choice(list(NORMALS), count)
    kind = np.array([KINDS[wall] for wall in walls])
    normal, place = (np.array(some) for some in zip(*[(NORMALS[w], place_at(w, rng)) for w in walls], strict=True))
    post = np.arange(count) % 7 == 0
    heading = rng.uniform(0.0, 2.0 * math.pi, count)
    kind[post], normal[post] = bounce.POST, np.stack([np.cos(heading), np.sin(heading)], axis=1)[post]
    closing, along = rng.uniform(0.3, 4.0, count), rng.uniform(-3.0, 3.0, count)
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    before = along[:, None] * tangent - closing[:, None] * normal
    zero = np.zeros(count)
    return WallContacts(
        kind=kind, normal=normal, t=np.sort(rng.uniform(0.0, 60.0, count)), place=place,
        velocity_before=before, velocity_after=-before,
        velocity_covariance=np.tile(1e-6 * np.eye(2), (count, 2, 1, 1)), common_errors=np.zeros((count, 2, 2, 0)),
        normal_std=zero, spin_chain=np.arange(count), spin_unknown=np.ones(count, bool),
        time_since_contact=np.full(count, 0.5), cluster=np.zeros(count, int),
    )  # fmt: skip


@pytest.mark.parametrize("component", COMPONENTS)
@pytest.mark.parametrize("basis", [*EACH, Stretch("y1", 0.5, 1.2).name, Stretch("x0", 0.05, 0.4).name])
def test_the_simulator_plays_the_law_that_was_fitted(basis, component):
    """A basis times coefficients, in addition to the walls' friction."""
    data, name = random_contacts(150), f"{component} by {basis}"
    problem = WallProblem(data, 1, {row.name: row.default for row in TABLE})
    shares = added_shares(data, Candidate(name, ()))
    theta = np.random.default_rng(4).normal(0.0, 0.5, shares.shape[1])
    baseline = {"wall_restitution": 0.6, "restitution_slope": 0.02, "tangential_ratio": 0.9}
    expected = problem.predicted(baseline)
    for axis in COMPONENTS[component]:
        expected[:, axis] += data.approach[:, axis] * (shares @ theta)
    kept = expected / data.approach
    assert kept.min() > 0.0 and kept.max() < 1.0  # nothing that a wall cannot do
    law = effect_parameters(name, data, theta)
    np.testing.assert_allclose(problem.predicted({**baseline, **law}), expected, atol=1e-9)


def test_a_law_of_the_time_since_a_contact_is_refused_by_name(tmp_path):
    assert set(BASIS_LIBRARY) - set(EFFECT_TABLES) == {"time since a contact"}
    assert effect_parameters("restitution by time since a contact", random_contacts(9), np.ones(4)) == {}
    found = Finding("wall", "unlisted", (), ("history",), "", {}, 1e-9, 2.0, 1.0)
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((RegimeResult("wall", (found,), {}, False, None),))))
    assert effect_values(file) == {}
    assert described(file) == [
        "not switched on: unlisted of the wall, which depends on history: "
        "the simulator does not store the time of the puck's last contact"
    ]


@pytest.fixture(scope="module", params=["time", pytest.param("position", marks=pytest.mark.long)])
def found(request, tmp_path_factory):
    """The law, what it depends on, and the effects.toml of a diagnosis of a minute on a table that has it."""
    law, seed = {"time": (WARMING, 5), "position": (WAVE, 1)}[request.param]
    folder = tmp_path_factory.mktemp(request.param)
    make_recording(folder / "table", law, "launches", seed, 60.0, camera=Camera(noise=0.0006, rate=150.0), dt=2e-5)
    diagnosis = diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None)
    (one,) = diagnosis.findings
    assert (one.mechanism, one.depends_on) == ("unlisted", (request.param,))
    if request.param == "position":
        assert one.parameters["size"].value == pytest.approx(0.07, rel=0.03)
        assert one.parameters["wave"].value == pytest.approx(0.61, rel=0.01)
    write(diagnosis, folder / "out")
    return law, request.param, folder / "out" / "effects.toml"


def test_contacts_keep_the_speed_that_they_keep_on_the_table_with_the_law(found):
    """Single contacts against the independent table's: equal to 0.002 of the speed for a law of time, to 0.01 for a
    wave, the best of many lengths; without the law they differ by more than 0.04."""
    law, depends, file = found
    tolerance = {"time": 0.002, "position": 0.01}[depends]
    rng = np.random.default_rng(8)
    values = effect_values(file)
    records = {"mended": make_records(1, values)[0], "baseline": make_records(1, {**values, "bounce_kind": 0.0})[0]}
    error = {name: [] for name in records}
    for _ in range(200):
        wall, t, speed, aside = rng.choice(list(NORMALS)), rng.uniform(1.0, 59.0), rng.uniform(0.5, 3.0), rng.normal()
        (nx, ny), (x, y) = NORMALS[wall], place_at(wall, rng)
        vx, vy = -speed * nx - aside * ny, -speed * ny + aside * nx
        real = np.array([x, y, vx, vy, 0.0, 0.0])
        off_wall(law.numbers(), t, list(NORMALS).index(wall), real, nx, ny)
        for name, p in records.items():
            puck = np.zeros(1, PUCK).view(np.recarray)[0]
            puck.x, puck.y, puck.vx, puck.vy = x, y, vx, vy
            rebound(puck, p, t, KINDS[wall], nx, ny)
            error[name].append(math.hypot(puck.vx - real[VX], puck.vy - real[VY]) / math.hypot(vx, vy))
    rms = {name: float(np.sqrt(np.mean(np.square(each)))) for name, each in error.items()}
    assert rms["baseline"] > 0.04
    assert rms["mended"] < tolerance


def test_players_meet_on_it(found, capsys):
    _, depends, file = found
    tables = Tables("match-v0", 1, effects=file)
    assert tables.params["bounce_kind"][0] == {"time": 3.0, "position": 6.0}[depends]
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(file), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
    assert "unlisted_bounce" in "".join(described(file))
