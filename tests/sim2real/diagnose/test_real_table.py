"""A real table, whose laws are unknown: a model found in a part of its recordings must predict the rest.

Robust error: the median of the absolute residual [m/s] of one component over all held-out wall contacts, so that
unrecorded contacts with a hand have little weight.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from sim2real.diagnose.engine.least_squares import given
from sim2real.diagnose.engine.model_search import SearchResult, search_model
from sim2real.diagnose.pipeline import diagnose
from sim2real.diagnose.regimes.contact.motion import find_contact_motions
from sim2real.diagnose.regimes.sliding.data import glide_data
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.regimes.wall.data import WallContacts, wall_contacts
from sim2real.diagnose.regimes.wall.problem import WallProblem
from sim2real.diagnose.regimes.wall.scatter import search_wall_model
from sim2real.recording.folder import Recording, read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.causes import geometry, mallet_tracks
from sim2real.segmentation.segments import Segments, segment
from tests.places import UBC

pytestmark = pytest.mark.slow

DEFAULTS = {row.name: row.default for row in TABLE if row.name in GlideProblem.base}
HALF = 83.3  # s, of a recording of 167 s


@dataclass(frozen=True)
class RecordingPart:
    recording: Recording
    segments: Segments
    glides: GlideProblem


@cache
def part(name: str) -> RecordingPart:
    if not (UBC / name).exists():
        pytest.skip(f"no recordings of the real table beside the project ({UBC / name})")
    recording = read_recording(UBC / name)
    segments = segment(recording)
    assert recording.frames is not None
    data = glide_data(segments, geometry(recording), mallet_tracks(recording, recording.frames.t))
    return RecordingPart(recording, segments, GlideProblem(data, parameters(recording, {})))


def begun(problem: GlideProblem) -> np.ndarray:
    """Return the start of each launch [s]."""
    first = np.full(problem.clusters, np.inf)
    np.minimum.at(first, problem.data.cluster, problem.data.t[problem.data.first[:-1]])
    return first


@cache
def glides_of_first_half() -> SearchResult:
    problem = part("play_a").glides
    return search_model(problem, DEFAULTS, np.flatnonzero(begun(problem) < HALF))


def bounces_of(name: str) -> tuple[WallContacts, int]:
    """Return the wall contacts of a recording, identified with the law of the glides, and its number of launches."""
    here = part(name)
    states = here.glides.states(given(glides_of_first_half().all_values))
    found = wall_contacts(find_contact_motions(here.segments, here.glides, states), geometry(here.recording))
    return found, here.glides.clusters


def typical(residual: np.ndarray) -> np.ndarray:
    return np.median(np.abs(residual), axis=0)


def test_the_glides_of_the_first_half_predict_the_second() -> None:
    found, problem = glides_of_first_half(), part("play_a").glides
    assert "table_warp" in [law.name for law in found.listed]
    assert found.unlisted is None or found.unlisted.family == "position"  # no real table is exactly a quadratic surface
    second = np.flatnonzero(begun(problem) >= HALF)
    before, after = (
        float(np.sum(problem.residuals(values, (), second).r ** 2))
        for values in (found.baseline.values, found.all_values)
    )
    print(f"glides, second half of play_a: RSS {after / before - 1:+.1%} against the refitted baseline")
    assert after < 0.3 * before


@pytest.mark.long
def test_the_wall_contacts_of_one_recording_predict_another() -> None:
    values = dict(glides_of_first_half().all_values)
    data, launches = bounces_of("play_a")
    _, found = search_wall_model(
        WallProblem(data, launches, values), {"wall_restitution": 0.7}, np.unique(data.cluster), True
    )
    assert {law.name for law in found.listed} == {"wall_friction_spin", "speed_dependent_restitution"}
    form = next(name for name in ("restitution_slope", "restitution_power") if name in found.law.free)  # both fit
    mu, fall = found.law.estimate("wall_mu"), found.law.estimate(form)
    print(f"mu {mu.value:.3f} [{mu.low:.3f}, {mu.high:.3f}]")
    print(f"{form} {fall.value:.4f} [{fall.low:.4f}, {fall.high:.4f}]")
    assert fall.low > 0.0
    assert mu.low < 0.11 < mu.high
    other, launches = bounces_of("puck_a")
    seen, before = other.components(other.velocity_after), other.components(other.velocity_before)
    defaults = typical(seen - np.array([-0.7, 0.7]) * before)
    refitted = typical(seen - found.baseline.values["wall_restitution"] * np.array([-1.0, 1.0]) * before)
    final = typical(seen - WallProblem(other, launches, values).predicted(found.law.values))
    for words, base in (("default parameters", defaults), ("refitted baseline", refitted)):
        change = final / base - 1.0
        print(f"puck_a's bounces, against the {words}: normal {change[0]:+.0%}, along the wall {change[1]:+.0%}")
    assert final[0] < 0.55 * defaults[0] and final[1] < 0.4 * defaults[1]
    assert final[0] < refitted[0] and final[1] < 0.4 * refitted[1]


@pytest.mark.long
def test_the_recordings_are_of_one_table() -> None:
    """Bounces that scatter, of a puck whose spin nobody knows, must not make two tables of one."""
    recordings = [part(name).recording for name in ("play_a", "puck_a")]
    found = diagnose(recordings, [], {}, lambda stage, share: None)
    assert (found.verdict, found.reason) == ("missing_physics", "")
    assert {"table_warp", "wall_friction_spin", "stamp_jitter"} <= {one.mechanism for one in found.findings}
