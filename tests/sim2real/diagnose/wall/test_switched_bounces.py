"""A law of bounces that no list has, found in a recording, then switched on in the simulator and played on."""

from __future__ import annotations

import math

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.effects_file import described, effect_values
from puckpilot_env.parameters import TABLE, make_records
from puckpilot_env.physics import bounce
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.rebound import rebound
from sim2real.diagnose.contact_laws import COMPONENTS
from sim2real.diagnose.diagnosis import Diagnosis, diagnose
from sim2real.diagnose.effects_toml import effects_toml
from sim2real.diagnose.engine.law import Law as Family
from sim2real.diagnose.files import write
from sim2real.diagnose.finding import Account, Finding
from sim2real.diagnose.wall.data import KINDS, Bounces
from sim2real.diagnose.wall.families import FAMILIES, ONE_WAVE, shares
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.diagnose.wall.switched import SWITCHES, switched_on
from sim2real.recording import read_recording
from tests.reality import Law
from tests.reality.bounce import off_wall
from tests.reality.camera import Camera
from tests.reality.puck import VX, VY
from tests.reality.record import make_recording

SIZE, RADIUS = (2.0, 1.0), 0.0309
NORMALS = {"x0": (1.0, 0.0), "x1": (-1.0, 0.0), "y0": (0.0, 1.0), "y1": (0.0, -1.0)}
WARMING = Law(wall_warming=-0.003, wall_restitution=0.85)
WAVE = Law(wall_wave=0.07, wall_wave_length=0.61, wall_restitution=0.8)
EACH = [name for name in SWITCHES if name not in list(ONE_WAVE)[1:]]  # and one wave for all


def place_on(wall: str, rng: np.random.Generator) -> np.ndarray:
    """A place (2,) [m] of a puck at a wall, clear of the goals."""
    axis, far = "xy".index(wall[0]), wall[1] == "1"
    place = np.array([rng.uniform(0.1, SIZE[0] - 0.1), rng.choice([0.1, 0.9]) + rng.uniform(-0.06, 0.06)])
    place[axis] = SIZE[axis] - RADIUS if far else RADIUS
    return place


def random_bounces(count: int) -> Bounces:
    """Off all walls and posts."""
    rng = np.random.default_rng(2)
    walls = rng.choice(list(NORMALS), count)
    kind = np.array([KINDS[wall] for wall in walls])
    normal, place = (np.array(some) for some in zip(*[(NORMALS[w], place_on(w, rng)) for w in walls], strict=True))
    post = np.arange(count) % 7 == 0
    heading = rng.uniform(0.0, 2.0 * math.pi, count)
    kind[post], normal[post] = bounce.POST, np.stack([np.cos(heading), np.sin(heading)], axis=1)[post]
    closing, along = rng.uniform(0.3, 4.0, count), rng.uniform(-3.0, 3.0, count)
    tangent = np.stack([-normal[:, 1], normal[:, 0]], axis=1)
    before = along[:, None] * tangent - closing[:, None] * normal
    zero = np.zeros(count)
    return Bounces(
        kind=kind, normal=normal, t=np.sort(rng.uniform(0.0, 60.0, count)), place=place, before=before, after=-before,
        spread=np.tile(1e-6 * np.eye(2), (count, 2, 1, 1)), drift=np.zeros((count, 2, 2, 0)), turn=zero,
        chain=np.arange(count), lost=np.ones(count, bool), since=np.full(count, 0.5), cluster=np.zeros(count, int),
    )  # fmt: skip


@pytest.mark.parametrize("component", COMPONENTS)
@pytest.mark.parametrize("family", EACH)
def test_the_simulator_s_bounces_are_the_family_s(family, component):
    """The family's own columns times coefficients, on top of walls that rub."""
    data, name = random_bounces(150), f"{component} by {family}"
    problem = WallProblem(data, 1, {row.name: row.default for row in TABLE})
    columns = shares(data, Family(name, ()))
    theta = np.random.default_rng(4).normal(0.0, 0.5, columns.shape[1])
    baseline = {"wall_restitution": 0.6, "restitution_slope": 0.02, "tangential_ratio": 0.9}
    expected = problem.predicted(baseline)
    for axis in COMPONENTS[component]:
        expected[:, axis] += (data.closing, data.sliding)[axis] * (columns @ theta)
    kept = expected / np.stack([data.closing, data.sliding], axis=1)
    assert kept.min() > 0.0 and kept.max() < 1.0  # nothing that a wall cannot do
    law = switched_on(name, data, theta)
    np.testing.assert_allclose(problem.predicted({**baseline, **law}), expected, atol=1e-9)


def test_what_remembers_a_contact_is_refused_by_name(tmp_path):
    assert set(FAMILIES) - set(SWITCHES) == {"time since a contact"}
    assert switched_on("restitution by time since a contact", random_bounces(9), np.ones(4)) == {}
    found = Finding("wall", "unlisted", (), ("history",), "", {}, 1e-9, 2.0, 1.0)
    file = tmp_path / "effects.toml"
    file.write_text(effects_toml(Diagnosis((Account("wall", (found,), {}, False, None),))))
    assert effect_values(file) == {}
    assert described(file) == [
        "not switched on: unlisted of the wall, which depends on history: "
        "a table does not know when its puck last touched something"
    ]


@pytest.fixture(scope="module", params=["time", "position"])
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


def test_bounces_keep_what_they_keep_on_the_table_with_the_law(found):
    """Single bounces against the reference's: to 0.002 of the speed by time, 0.01 by a wave, the best of
    many lengths, where without the law they are off by more than 0.04."""
    law, depends, file = found
    tolerance = {"time": 0.002, "position": 0.01}[depends]
    rng = np.random.default_rng(8)
    values = effect_values(file)
    records = {"mended": make_records(1, values)[0], "baseline": make_records(1, {**values, "bounce_kind": 0.0})[0]}
    miss = {name: [] for name in records}
    for _ in range(200):
        wall, t, speed, aside = rng.choice(list(NORMALS)), rng.uniform(1.0, 59.0), rng.uniform(0.5, 3.0), rng.normal()
        (nx, ny), (x, y) = NORMALS[wall], place_on(wall, rng)
        vx, vy = -speed * nx - aside * ny, -speed * ny + aside * nx
        real = np.array([x, y, vx, vy, 0.0, 0.0])
        off_wall(law.numbers(), t, list(NORMALS).index(wall), real, nx, ny)
        for name, p in records.items():
            puck = np.zeros(1, PUCK).view(np.recarray)[0]
            puck.x, puck.y, puck.vx, puck.vy = x, y, vx, vy
            rebound(puck, p, t, KINDS[wall], nx, ny)
            miss[name].append(math.hypot(puck.vx - real[VX], puck.vy - real[VY]) / math.hypot(vx, vy))
    rms = {name: float(np.sqrt(np.mean(np.square(each)))) for name, each in miss.items()}
    assert rms["baseline"] > 0.04
    assert rms["mended"] < tolerance


def test_players_meet_on_it(found, capsys):
    _, depends, file = found
    tables = Tables("match-v0", 1, effects=file)
    assert tables.params["bounce_kind"][0] == {"time": 3.0, "position": 6.0}[depends]
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(file), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
    assert "unlisted_bounce" in "".join(described(file))
