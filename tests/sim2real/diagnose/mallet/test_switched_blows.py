"""A law of blows that no list has, found in a recording, then switched on in the simulator and played on."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.effects_file import described, effect_values
from puckpilot_env.parameters import TABLE, make_records
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.rebound import strike
from sim2real.diagnose.contact_laws import COMPONENTS, UNIT
from sim2real.diagnose.diagnosis import diagnose
from sim2real.diagnose.engine import gram
from sim2real.diagnose.files import write
from sim2real.diagnose.mallet.data import Blows
from sim2real.diagnose.mallet.families import FAMILIES
from sim2real.diagnose.mallet.problem import MalletProblem
from sim2real.diagnose.mallet.switched import KINDS, switched_on
from sim2real.recording import read_recording
from tests.reality import Law
from tests.reality.bounce import off_mallet
from tests.reality.puck import VX, VY
from tests.reality.record import make_recording

WARMING = Law(mallet_warming=-0.004, mallet_restitution=0.85)
DEFAULTS = {row.name: row.default for row in TABLE}


def random_blows(count: int) -> Blows:
    """By a mallet that moves, everywhere in its half."""
    rng = np.random.default_rng(2)
    heading, along = rng.uniform(0.0, 2.0 * math.pi, count), rng.normal(size=count)
    closing = rng.uniform(0.3, 4.0, count)
    normal, tangent = (np.stack([np.cos(turn), np.sin(turn)], axis=1) for turn in (heading, heading + 0.5 * math.pi))
    driven = rng.normal(size=(count, 2))
    before = driven + along[:, None] * tangent - closing[:, None] * normal
    return Blows(
        normal=normal, t=np.sort(rng.uniform(0.0, 60.0, count)), place=rng.uniform(0.1, 0.9, (count, 2)),
        before=before, after=-before, driven=driven, step=np.zeros(count), turn=np.zeros(count),
        swing=np.tile(1e-6 * np.eye(3), (count, 1, 1)), spread=np.tile(1e-6 * np.eye(2), (count, 2, 1, 1)),
        drift=np.zeros((count, 2, 2, 0)), chain=np.arange(count),
        lost=np.ones(count, bool), cluster=np.zeros(count, int),
    )  # fmt: skip


@pytest.mark.parametrize("component", COMPONENTS)
@pytest.mark.parametrize("family", FAMILIES)
def test_the_simulator_s_blows_are_the_family_s(family, component):
    """The family's own columns times coefficients, on top of mallets that rub."""
    data = random_blows(150)
    problem = MalletProblem(data, 1, DEFAULTS)
    weights = UNIT * FAMILIES[family][1](data)
    theta = np.random.default_rng(4).uniform(-1.0, 0.0, weights.shape[1])
    baseline = {"mallet_restitution": 0.6, "mallet_restitution_slope": 0.02, "mallet_mu": 0.1}
    expected, swing = problem.predicted(baseline), data.split(data.driven)
    for axis in COMPONENTS[component]:
        expected[:, axis] += (data.closing, data.sliding)[axis] * (weights @ theta)
    left = (expected[:, :2] - swing) / np.stack([data.closing, data.sliding], axis=1)
    assert left[:, 0].min() > 0.0 and left[:, 0].max() < 1.0  # nothing that a mallet cannot do
    rubbed = left[:, 1] > 0.0  # friction may have turned the speed along round
    law = switched_on(f"mallet's {component} by {family}", data, theta)
    found = problem.predicted({**baseline, **law})
    np.testing.assert_allclose(found[:, [0, 2]], expected[:, [0, 2]], atol=1e-9)
    np.testing.assert_allclose(found[rubbed, 1], expected[rubbed, 1], atol=1e-9)
    assert rubbed.mean() > 0.8


def test_where_a_mallet_recoils_it_recoils_from_the_further_impulse_too():
    """The puck's velocity is the family's; the mallet's step is the ratio of masses times all that the puck gains."""
    data, give = random_blows(50), {"mallet_give": 0.1}
    problem, theta = MalletProblem(data, 1, DEFAULTS), np.array([-0.5, 0.3, -0.2, -0.8])
    more = data.closing * (UNIT * FAMILIES["time"][1](data) @ theta)
    found = problem.predicted({**give, **switched_on("mallet's restitution by time", data, theta)})
    expected = problem.predicted(give) + more[:, None] * [1.0, 0.0, -0.1]
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize("give", [0.0, 0.1])
def test_a_family_s_columns_are_what_the_simulator_changes_by(give):
    """Recoil and all, of a mallet that is heavy or light: the columns times coefficients are the residuals' change."""
    data = random_blows(40)
    problem, values = MalletProblem(data, 1, DEFAULTS), {"mallet_restitution": 0.7, "mallet_give": give}
    columns = problem.columns(values, (), None)
    law = next(one for one in columns.families if one.name == "mallet's restitution by time")
    theta = np.linspace(-0.5, 0.5, len(law.columns))
    index = columns.grams.columns(law.columns)
    claimed = gram.losses(columns.grams, index, theta, np.arange(len(data)))
    left = problem.residuals({**values, **law.switch(theta)}, (), np.arange(1)).r
    np.testing.assert_allclose(claimed, (left**2).reshape(-1, 3).sum(axis=1), rtol=1e-6)


def test_every_family_is_switched_on_by_its_law():
    assert set(KINDS) == set(FAMILIES)
    data = random_blows(20)
    problem = MalletProblem(data, 1, DEFAULTS)
    for law in problem.columns({"mallet_restitution": 0.7}, problem.base, None).families:
        kind, share = (law.switch(np.ones(len(law.columns)))[name] for name in ("blow_kind", "blow_share"))
        component, family = law.name.removeprefix("mallet's ").split(" by ", 1)
        assert law.straight and (kind, share) == (KINDS[family], 1 + list(COMPONENTS).index(component))
    same = switched_on("mallet's restitution by time", _at_once(data), np.array([0.7]))
    assert (same["blow_03"], same["blow_07"]) == (3.0, pytest.approx(0.07))  # a single knot stands for all


def _at_once(data: Blows) -> Blows:
    return replace(data, t=np.full(len(data), 3.0))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The effects.toml of a diagnosis of a minute on a table whose mallet has the law."""
    folder = tmp_path_factory.mktemp("blows")
    make_recording(folder / "table", WARMING, "rally", 1, 60.0, dt=2e-5)
    diagnosis = diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None)
    (one,) = diagnosis.findings
    assert (one.regime, one.mechanism, one.depends_on) == ("mallet", "unlisted", ("time",))
    write(diagnosis, folder / "out")
    return folder / "out" / "effects.toml"


def test_blows_keep_what_they_keep_on_the_table_with_the_law(found):
    """Single blows against the reference's: to 0.01 of the speed past the mallet, where without the law they are off by
    more than 0.04."""
    rng, values = np.random.default_rng(8), effect_values(found)
    records = {"mended": make_records(1, values)[0], "baseline": make_records(1, {**values, "blow_kind": 0.0})[0]}
    miss = {name: [] for name in records}
    for _ in range(200):
        t, speed, aside, heading = rng.uniform(1.0, 59.0), rng.uniform(0.5, 3.0), rng.normal(), rng.uniform(-1.0, 1.0)
        nx, ny, (mx, my) = math.cos(heading), math.sin(heading), rng.normal(size=2)
        vx, vy = mx - speed * nx - aside * ny, my - speed * ny + aside * nx
        real, mallets = np.array([0.4, 0.5, vx, vy, 0.0, 0.0]), np.array([[0.0, mx, 0.0, 0.0, my, 0.0]])
        off_mallet(WARMING.numbers(), t, 0, real, mallets, nx, ny)
        for name, p in records.items():
            puck = np.zeros(1, PUCK).view(np.recarray)[0]
            puck.x, puck.y, puck.vx, puck.vy = 0.4, 0.5, vx, vy
            strike(puck, p, t, mx, my, nx, ny)
            miss[name].append(math.hypot(puck.vx - real[VX], puck.vy - real[VY]) / math.hypot(speed, aside))
    rms = {name: float(np.sqrt(np.mean(np.square(each)))) for name, each in miss.items()}
    assert rms["baseline"] > 0.04
    assert rms["mended"] < 0.01


def test_players_meet_on_it(found, capsys):
    assert Tables("match-v0", 1, effects=found).params["blow_kind"][0] == 5.0
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(found), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
    assert "unlisted_blow" in "".join(described(found))
