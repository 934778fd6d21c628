"""The columns of one smooth term alone are those that it has among all of them."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.problem import DesignMatrix, Problem
from sim2real.diagnose.regimes.gantry.problem import gantry_problem
from sim2real.diagnose.regimes.mallet.problem import MalletProblem
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.split import glides_of
from sim2real.recording.folder import read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.record import make_recording
from tests.sim2real.diagnose.regimes.mallet.test_as_effect import DEFAULTS, random_contacts


def glides(folder: Path) -> GlideProblem:
    make_recording(folder, Law(), "launches", 2, 12.0)
    recording = read_recording(folder)
    return GlideProblem(glides_of(recording, segment(recording)), parameters(recording))


def gantry(folder: Path, seconds: float = 14.0) -> Problem:
    make_recording(folder, Law(), "gantry", 7, seconds)
    recording = read_recording(folder)
    return gantry_problem([recording], parameters(recording))[0]


def equations_of(columns: DesignMatrix, name: str, free: tuple[str, ...]) -> list[np.ndarray]:
    """G and b of one smooth term beside the free parameters."""
    law = next(one for one in columns.families if one.name == name)
    at = columns.equations.columns([*free, *law.columns])
    return list(normal_equations.restricted(columns.equations, at, np.arange(columns.equations.clusters)).whole())


@pytest.mark.slow
@pytest.mark.parametrize("make", [glides, gantry, lambda folder: MalletProblem(random_contacts(80), 1, DEFAULTS)])
def test_a_term_alone_is_what_it_is_among_all(make, tmp_path: Path) -> None:
    problem = make(tmp_path / "table")
    values = {name: DEFAULTS[name] for name in problem.base}
    every = problem.columns(values, problem.base, None)
    for law in (every.families[0], every.families[-1]):
        alone = problem.columns(values, problem.base, None, only=[law])
        assert [one.name for one in alone.families] == [law.name]
        for wanted, found in zip(*(equations_of(one, law.name, problem.base) for one in (every, alone)), strict=True):
            np.testing.assert_allclose(found, wanted, rtol=1e-9, atol=1e-9 * np.abs(wanted).max())


@pytest.mark.slow
def test_fitted_starts_do_not_depend_on_the_laws_that_were_asked_for_before(tmp_path: Path) -> None:
    problem = glides(tmp_path / "table")
    laws = [{"friction": 0.1 + 0.02 * k, "drag": 0.05} for k in range(9)]
    first = [problem.residuals(law, ("friction",), np.arange(problem.clusters)) for law in laws]
    for law, before in reversed(list(zip(laws, first, strict=True))):
        again = problem.residuals(law, ("friction",), np.arange(problem.clusters))
        np.testing.assert_array_equal(again.r, before.r)
        np.testing.assert_array_equal(again.jacobian, before.jacobian)
    assert not np.array_equal(first[0].r, first[1].r)


@pytest.mark.slow
def test_a_long_record_of_the_gantry_is_thinned_by_blocks(tmp_path: Path) -> None:
    """So that its windows keep samples enough to tell something beside their starts."""
    run = gantry(tmp_path / "table", 60.0).runs[0]  # pyright: ignore[reportAttributeAccessIssue]
    few, all_of_it = run.thinned(300), run.thinned(10**6)
    sizes = few.windows.end - few.windows.begin
    assert np.median(sizes) >= 8 and 200 < sizes.sum() < 400
    assert set(np.unique(few.windows.cluster)) == set(range(few.windows.clusters))
    assert few.t[few.windows.begin[-1]] > 0.8 * run.t[-1]  # over the whole length
    assert len(all_of_it.windows.begin) == len(run.windows.begin) and len(all_of_it.t) == len(run.t)
