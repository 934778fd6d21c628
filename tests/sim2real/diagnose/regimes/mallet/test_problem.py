"""The engine identifies the law of a mallet from contacts recorded by an independent table."""

from dataclasses import replace

import numpy as np
import pytest

from sim2real.diagnose.engine.least_squares import fit
from sim2real.diagnose.engine.model_search import search_model
from sim2real.diagnose.regimes.contact.motion import find_contact_motions
from sim2real.diagnose.regimes.mallet.data import MalletContacts, mallet_contacts
from sim2real.diagnose.regimes.mallet.gross_errors import without_gross_errors
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.diagnose.regimes.sliding.data import glide_data
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.recording.folder import read_recording
from sim2real.segmentation.causes import geometry, mallet_tracks
from sim2real.segmentation.mallet_path import robot_path, wiener_covariance
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.record import make_recording


def explained(folder, law: Law, seed: int):
    """The mallet's law that the engine identifies from 60 s of a rally."""
    make_recording(folder, law, "rally", seed, 60.0, dt=5e-5)
    recording = read_recording(folder)
    segments, g = segment(recording), geometry(recording)
    assert recording.frames is not None
    sizes = {"length": g.length, "width": g.width, "puck_radius": g.puck_radius}
    glides = GlideProblem(glide_data(segments, g, mallet_tracks(recording, recording.frames.t)), sizes)
    braking = fit(glides, {"friction": 0.125, "drag": 0.125}, glides.base, np.arange(glides.clusters))
    encoders = robot_path(recording)
    assert encoders is not None
    problem = MalletProblem(
        mallet_contacts(find_contact_motions(segments, glides, glides.states(braking)), encoders, g),
        glides.clusters,
        sizes,
    )
    return search_model(problem, {"mallet_restitution": 0.7}, np.flatnonzero(problem.freedom > 0))


@pytest.mark.slow
def test_a_rigid_mallet_of_another_restitution_lacks_nothing(tmp_path):
    found = explained(tmp_path, Law(mallet_restitution=0.6), 1)
    assert found.listed == () and found.unlisted is None and not found.defaults
    assert found.baseline.values["mallet_restitution"] == pytest.approx(0.6, abs=0.01)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("law", "seed", "mechanism", "name", "truth"),
    [
        (Law(mallet_give=0.05), 2, "mallet_give", "mallet_give", 0.05),
        (Law(mallet_mu=0.15), 3, "mallet_friction", "mallet_mu", 0.15),
        (Law(mallet_restitution_slope=0.06), 4, "mallet_speed_restitution", "mallet_restitution_slope", 0.06),
    ],
)
def test_each_mechanism_is_named(tmp_path, law, seed, mechanism, name, truth):
    found = explained(tmp_path, law, seed)
    assert [one.name for one in found.listed] == [mechanism] and found.unlisted is None
    assert found.law.estimate(name).low < truth < found.law.estimate(name).high


def test_a_restless_acceleration_spreads_as_its_integral():
    """Against sums of steps of a Wiener process, integrated twice."""
    rng = np.random.default_rng(1)
    step, n = 0.01, 100
    acceleration = np.cumsum(rng.normal(0, np.sqrt(step), (4000, n)), axis=1)
    place = np.cumsum(np.cumsum(acceleration, axis=1) * step, axis=1) * step
    spread = wiener_covariance(np.array([0.5, 1.0]))
    np.testing.assert_allclose(np.cov(place[:, [49, 99]].T), spread, rtol=0.15)


def struck(late: np.ndarray) -> MalletContacts:
    """Contacts of a disc with a heavy mallet, e = 0.7, by hand; the mallet of recording k is seen late[k] [s] late."""
    rng, count, radii, std = np.random.default_rng(3), 40, 0.08, 3e-3
    recording, heading = np.arange(count) % len(late), rng.uniform(0.0, 2.0 * np.pi, count)
    mallet, before = rng.normal(0.0, 2.0, (count, 2)), rng.normal(0.0, 0.5, (count, 2))
    acceleration = rng.normal(0.0, 100.0, (count, 2))
    normal = np.stack([np.cos(heading), np.sin(heading)], axis=1)
    before -= (2.0 + ((before - mallet) * normal).sum(axis=1))[:, None] * normal  # they close at 2 m/s
    after = before + (1.0 + 0.7) * 2.0 * normal + rng.normal(0.0, std, (count, 2))
    away = radii * normal + late[recording, None] * mallet
    distance = np.linalg.norm(away, axis=1)
    seen = away / distance[:, None]
    return MalletContacts(
        normal=seen, t=np.arange(count, dtype=float), place=np.full((count, 2), 0.5),
        velocity_before=before, velocity_after=after, mallet_step=np.zeros(count),
        mallet_velocity=mallet - late[recording, None] * acceleration, mallet_acceleration=acceleration,
        mallet_covariance=np.tile(1e-12 * np.eye(3), (count, 1, 1)) + np.diag([0.0, 0.0, std**2]),
        velocity_covariance=np.stack([np.zeros((count, 2, 2)), np.tile(std**2 * np.eye(2), (count, 1, 1))], axis=1),
        common_errors=np.zeros((count, 2, 2, 0)), normal_std=np.zeros(count), spin_chain=np.arange(count),
        spin_unknown=np.zeros(count, bool), cluster=recording, recording=recording,
        turning=(mallet[:, 1] * -seen[:, 0] + mallet[:, 0] * seen[:, 1]) / distance,
    )  # fmt: skip


@pytest.mark.parametrize("late", [[0.0003], [-0.0003], [0.0004, -0.0002]])
def test_an_offset_of_the_mallets_clock_is_no_misfit_of_contacts(late):
    """It turns all normals of a recording, which is ten times the noise of velocities; without it nothing changes."""
    contacts, values = struck(np.array(late)), {"mallet_restitution": 0.7}
    none = np.zeros_like(contacts.mallet_acceleration)
    blind, steady = replace(contacts, turning=none[:, 0]), replace(contacts, mallet_acceleration=none)
    rms = [
        float(np.sqrt((MalletProblem(each, 2, {}).residuals(values, (), np.arange(2)).r ** 2).mean()))
        for each in (contacts, blind, steady, struck(np.zeros(1)))
    ]
    assert rms[0] < 1.2 and min(rms[1:3]) > 3.0 and 0.7 < rms[3] < 1.1


@pytest.mark.parametrize("restitution", [0.7, 0.45])
def test_a_contact_that_was_measured_wrongly_does_not_spoil_the_clock_of_all(restitution):
    """One of 40 is off by 3 m/s, a thousand times the noise: with it the clock's error is wrong for all others."""
    contacts = struck(np.array([0.0003]))
    slower = (restitution - 0.7) * 2.0 * contacts.normal
    wrong = contacts.velocity_after + slower
    wrong[7] += 3.0 * contacts.axes[7, 1]
    spoilt = MalletProblem(replace(contacts, velocity_after=wrong), 2, {})
    mended = without_gross_errors(spoilt)
    values, others = {"mallet_restitution": restitution}, np.arange(40) != 7
    with_it = spoilt.residuals(values, (), np.arange(2)).r.reshape(40, 3)[others]
    assert mended.left_out == 1 and len(mended.data) == 39
    assert np.sqrt((with_it**2).mean()) > 3.0
    assert np.sqrt((mended.residuals(values, (), np.arange(2)).r ** 2).mean()) < 1.5


def test_contacts_that_scatter_alike_are_all_kept():
    contacts = struck(np.array([0.0004, -0.0002]))
    for scatter in (0.0, 0.3):
        noise = np.random.default_rng(5).normal(0.0, 1.0, contacts.velocity_after.shape) * scatter
        problem = MalletProblem(replace(contacts, velocity_after=contacts.velocity_after + noise), 2, {})
        assert without_gross_errors(problem) is problem
