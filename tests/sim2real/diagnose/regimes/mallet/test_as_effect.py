"""An unlisted law of the mallet is identified from a recording, switched on in the simulator, and used in games."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env import Tables
from puckpilot_env.options.effects_file import described, effect_values
from puckpilot_env.parameters import TABLE, make_records
from puckpilot_env.physics.advance import PUCK
from puckpilot_env.physics.contacts.rebound import strike
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.output.files import write
from sim2real.diagnose.pipeline import diagnose
from sim2real.diagnose.regimes.contact.candidates import COMPONENTS
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.mallet.as_effect import EFFECT_KINDS, effect_parameters
from sim2real.diagnose.regimes.mallet.basis_library import BASIS_LIBRARY
from sim2real.diagnose.regimes.mallet.data import MalletContacts
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.recording.folder import read_recording
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.physics.bounce import off_mallet
from sim2real.study.independent_table.physics.puck import VX, VY
from sim2real.study.independent_table.recorder.record import make_recording

pytestmark = pytest.mark.slow

WARMING = Law(mallet_warming=-0.004, mallet_restitution=0.85)
DEFAULTS = {row.name: row.default for row in TABLE}


def random_contacts(count: int) -> MalletContacts:
    """Contacts with a moving mallet, everywhere in its half."""
    rng = np.random.default_rng(2)
    heading, along = rng.uniform(0.0, 2.0 * math.pi, count), rng.normal(size=count)
    closing = rng.uniform(0.3, 4.0, count)
    normal, tangent = (np.stack([np.cos(turn), np.sin(turn)], axis=1) for turn in (heading, heading + 0.5 * math.pi))
    mallet_velocity = rng.normal(size=(count, 2))
    before = mallet_velocity + along[:, None] * tangent - closing[:, None] * normal
    return MalletContacts(
        normal=normal, t=np.sort(rng.uniform(0.0, 60.0, count)), place=rng.uniform(0.1, 0.9, (count, 2)),
        velocity_before=before, velocity_after=-before, mallet_velocity=mallet_velocity, mallet_step=np.zeros(count),
        normal_std=np.zeros(count), turning=np.zeros(count),
        mallet_acceleration=np.zeros((count, 2)), recording=np.zeros(count, int),
        mallet_covariance=np.tile(1e-6 * np.eye(3), (count, 1, 1)),
        velocity_covariance=np.tile(1e-6 * np.eye(2), (count, 2, 1, 1)),
        common_errors=np.zeros((count, 2, 2, 0)), spin_chain=np.arange(count),
        spin_unknown=np.ones(count, bool), cluster=np.zeros(count, int),
    )  # fmt: skip


@pytest.mark.parametrize("component", COMPONENTS)
@pytest.mark.parametrize("basis", BASIS_LIBRARY)
def test_the_simulator_plays_the_law_that_was_fitted(basis, component):
    """A basis times coefficients, in addition to the mallet's friction."""
    data = random_contacts(150)
    problem = MalletProblem(data, 1, DEFAULTS)
    shares = CONTACT.coefficient_unit * BASIS_LIBRARY[basis][1](data)
    theta = np.random.default_rng(4).uniform(-1.0, 0.0, shares.shape[1])
    baseline = {"mallet_restitution": 0.6, "mallet_restitution_slope": 0.02, "mallet_mu": 0.1}
    expected, mallet = problem.predicted(baseline), data.components(data.mallet_velocity)
    for axis in COMPONENTS[component]:
        expected[:, axis] += data.approach[:, axis] * (shares @ theta)
    kept = (expected[:, :2] - mallet) / data.approach
    assert kept[:, 0].min() > 0.0 and kept[:, 0].max() < 1.0  # nothing that a mallet cannot do
    rubbed = kept[:, 1] > 0.0  # friction may have reversed the tangential velocity
    law = effect_parameters(f"mallet's {component} by {basis}", data, theta)
    found = problem.predicted({**baseline, **law})
    np.testing.assert_allclose(found[:, [0, 2]], expected[:, [0, 2]], atol=1e-9)
    np.testing.assert_allclose(found[rubbed, 1], expected[rubbed, 1], atol=1e-9)
    assert rubbed.mean() > 0.8


def test_a_mallet_recoils_from_the_law_s_impulse_too():
    """The mallet's step is the ratio of masses times all that the puck gains."""
    data, give = random_contacts(50), {"mallet_give": 0.1}
    problem, theta = MalletProblem(data, 1, DEFAULTS), np.array([-0.5, 0.3, -0.2, -0.8])
    more = data.closing_speed * (CONTACT.coefficient_unit * BASIS_LIBRARY["time"][1](data) @ theta)
    found = problem.predicted({**give, **effect_parameters("mallet's restitution by time", data, theta)})
    expected = problem.predicted(give) + more[:, None] * [1.0, 0.0, -0.1]
    np.testing.assert_allclose(found, expected, atol=1e-9)


@pytest.mark.parametrize("give", [0.0, 0.1])
def test_a_law_s_columns_are_what_the_simulator_changes_by(give):
    """Columns times coefficients are the change of the residuals, recoil included, for a heavy and a light mallet."""
    data = random_contacts(40)
    problem, values = MalletProblem(data, 1, DEFAULTS), {"mallet_restitution": 0.7, "mallet_give": give}
    columns = problem.columns(values, (), None)
    law = next(one for one in columns.families if one.name == "mallet's restitution by time")
    theta = np.linspace(-0.5, 0.5, len(law.columns))
    index = columns.equations.columns(law.columns)
    claimed = normal_equations.losses(columns.equations, index, theta, np.arange(len(data)))
    left = problem.residuals({**values, **law.switch(theta)}, (), np.arange(1)).r
    np.testing.assert_allclose(claimed, (left**2).reshape(-1, 3).sum(axis=1), rtol=1e-6)


def test_every_basis_is_played_by_its_own_kind_of_effect():
    assert set(EFFECT_KINDS) == set(BASIS_LIBRARY)
    data = random_contacts(20)
    problem = MalletProblem(data, 1, DEFAULTS)
    for law in problem.columns({"mallet_restitution": 0.7}, problem.base, None).families:
        kind, share = (law.switch(np.ones(len(law.columns)))[name] for name in ("blow_kind", "blow_share"))
        component, basis = law.name.removeprefix("mallet's ").split(" by ", 1)
        assert law.linear and (kind, share) == (EFFECT_KINDS[basis], 1 + list(COMPONENTS).index(component))
    same = effect_parameters("mallet's restitution by time", _at_once(data), np.array([0.7]))
    assert (same["blow_03"], same["blow_07"]) == (3.0, pytest.approx(0.07))  # a single knot is repeated


def _at_once(data: MalletContacts) -> MalletContacts:
    return replace(data, t=np.full(len(data), 3.0))


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    """The effects.toml of a diagnosis of a minute on a table whose mallet has the law."""
    folder = tmp_path_factory.mktemp("mallet")
    make_recording(folder / "table", WARMING, "rally", 1, 60.0, dt=2e-5)
    diagnosis = diagnose([read_recording(folder / "table")], [], {}, lambda stage, share: None)
    (one,) = diagnosis.findings
    assert (one.regime, one.mechanism, one.depends_on) == ("mallet", "unlisted", ("time",))
    write(diagnosis, folder / "out")
    return folder / "out" / "effects.toml"


def test_contacts_keep_the_speed_that_they_keep_on_the_table_with_the_law(found):
    """Single contacts against the independent table's: equal to 0.01 of the speed relative to the mallet; without the
    law they differ by more than 0.04."""
    rng, values = np.random.default_rng(8), effect_values(found)
    records = {"mended": make_records(1, values)[0], "baseline": make_records(1, {**values, "blow_kind": 0.0})[0]}
    error = {name: [] for name in records}
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
            error[name].append(math.hypot(puck.vx - real[VX], puck.vy - real[VY]) / math.hypot(speed, aside))
    rms = {name: float(np.sqrt(np.mean(np.square(each)))) for name, each in error.items()}
    assert rms["baseline"] > 0.04
    assert rms["mended"] < 0.01


def test_players_meet_on_it(found, capsys):
    assert Tables("match-v0", 1, effects=found).params["blow_kind"][0] == 5.0
    assert main(["match", "goalie", "follower", "--games", "2", "--effects", str(found), "--json"]) == 0
    assert '"games"' in capsys.readouterr().out
    assert "unlisted_blow" in "".join(described(found))
