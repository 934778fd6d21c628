"""A real table, of which nobody knows the law: what is found in a part of its recordings must foretell the rest.

Robust error: the median of the absolute residual [m/s] of one component over all held-out bounces, so that blows of a
hand that nobody recorded count as little as they should.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from puckpilot_env.parameters import TABLE
from sim2real.diagnose.contacts import geometry, mallet_tracks
from sim2real.diagnose.engine.explain import Explained, explain
from sim2real.diagnose.engine.fit import given
from sim2real.diagnose.glide.data import glide_data
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.impacts import find_impacts
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.wall.data import Bounces, bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.diagnose.wall.scatter import explain_bounces
from sim2real.nominal import parameters
from sim2real.recording import Recording, read_recording

UBC = Path(__file__).resolve().parents[4] / "shared" / "recordings" / "ubc"
SHIPPED = {row.name: row.default for row in TABLE if row.name in GlideProblem.base}
HALF = 83.3  # s, of a recording of 167 s


@dataclass(frozen=True)
class Part:
    recording: Recording
    pieces: Pieces
    glides: GlideProblem


@cache
def part(name: str) -> Part:
    if not (UBC / name).exists():
        pytest.skip(f"no recordings of the real table beside the project ({UBC / name})")
    recording = read_recording(UBC / name)
    pieces = cut(recording)
    assert recording.frames is not None
    data = glide_data(pieces, geometry(recording), mallet_tracks(recording, recording.frames.t))
    return Part(recording, pieces, GlideProblem(data, parameters(recording, {})))


def begun(problem: GlideProblem) -> np.ndarray:
    """When each launch begins [s]."""
    first = np.full(problem.clusters, np.inf)
    np.minimum.at(first, problem.data.cluster, problem.data.t[problem.data.first[:-1]])
    return first


@cache
def glides_of_first_half() -> Explained:
    problem = part("play_a").glides
    return explain(problem, SHIPPED, np.flatnonzero(begun(problem) < HALF))


def bounces_of(name: str) -> tuple[Bounces, int]:
    """The bounces of a recording, told by the law of the glides, and its number of launches."""
    here = part(name)
    states = here.glides.states(given(glides_of_first_half().mended))
    found = bounces(find_impacts(here.pieces, here.glides, states), geometry(here.recording))
    return found, here.glides.clusters


def typical(residual: np.ndarray) -> np.ndarray:
    return np.median(np.abs(residual), axis=0)


def test_what_the_first_half_s_glides_say_holds_in_the_second() -> None:
    found, problem = glides_of_first_half(), part("play_a").glides
    assert "table_warp" in [law.name for law in found.listed]
    assert found.unlisted is None or found.unlisted.family == "position"  # no real table is quite a quadratic surface
    second = np.flatnonzero(begun(problem) >= HALF)
    before, after = (
        float(np.sum(problem.residuals(values, (), second).r ** 2)) for values in (found.baseline.values, found.mended)
    )
    print(f"glides, second half of play_a: RSS {after / before - 1:+.1%} against the refitted baseline")
    assert after < 0.3 * before


def test_what_the_bounces_of_one_recording_say_holds_in_another() -> None:
    values = dict(glides_of_first_half().mended)
    data, launches = bounces_of("play_a")
    _, found = explain_bounces(
        WallProblem(data, launches, values), {"wall_restitution": 0.7}, np.unique(data.cluster), True
    )
    assert {law.name for law in found.listed} == {"wall_friction_spin", "speed_dependent_restitution"}
    mu, slope = found.law.estimate("wall_mu"), found.law.estimate("restitution_slope")
    print(
        f"mu {mu.value:.3f} [{mu.low:.3f}, {mu.high:.3f}], slope {slope.value:.4f} [{slope.low:.4f}, {slope.high:.4f}]"
    )
    assert mu.low < 0.11 < mu.high
    other, launches = bounces_of("puck_a")
    seen, before = other.split(other.after), other.split(other.before)
    shipped = typical(seen - np.array([-0.7, 0.7]) * before)
    refitted = typical(seen - found.baseline.values["wall_restitution"] * np.array([-1.0, 1.0]) * before)
    final = typical(seen - WallProblem(other, launches, values).predicted(found.law.values))
    for words, base in (("shipped", shipped), ("refitted baseline", refitted)):
        change = final / base - 1.0
        print(f"puck_a's bounces, against the {words}: normal {change[0]:+.0%}, along the wall {change[1]:+.0%}")
    assert final[0] < 0.55 * shipped[0] and final[1] < 0.4 * shipped[1]
    assert final[0] < refitted[0] and final[1] < 0.4 * refitted[1]
