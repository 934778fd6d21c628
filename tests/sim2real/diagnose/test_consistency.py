"""Several recordings in one call: recordings of one table are pooled, those of two tables are undetermined."""

import json
from contextlib import nullcontext
from functools import cache
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from puckpilot import main
from sim2real.diagnose import consistency
from sim2real.diagnose.consistency import check_consistency
from sim2real.diagnose.engine.problem import Residuals, Units
from sim2real.diagnose.input_checks import UndeterminedError
from sim2real.diagnose.pipeline import diagnose
from sim2real.diagnose.regimes.base import RecordingPart
from sim2real.diagnose.regimes.sliding.data import glide_data, join
from sim2real.diagnose.regimes.sliding.problem import GlideProblem
from sim2real.diagnose.tuned import CONSISTENCY
from sim2real.recording.folder import read_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.segments import segment
from sim2real.study.independent_table.cases import draw_case
from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording

CAMERA = Camera(noise=0.0006, rate=150.0)
VORTEX = Law(vortex=0.06, vortex_x=1.0, vortex_y=0.5, vortex_size=0.3)
LAWS = {
    "plain": Law(),
    "tilted": Law(tilt_x=0.02),
    "tilted again": Law(tilt_x=0.02),
    "tilted back": Law(tilt_x=-0.02),
    "slick": Law(friction=0.09, wall_restitution=0.8),
    "lively": Law(wall_restitution=0.8),
    "patched": Law(patch_x=1.0, patch_y=0.5, patch_radius=0.2, patch_friction=0.15),
    "whirling": VORTEX,
    "whirling again": VORTEX,
    "large": Law(length=2.06, width=1.03),
}
LOCAL = {"patched", "whirling", "whirling again"}  # laws of a part of the table, which only some launches cross


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Record a table of LAWS, once, each with another seed. All state a table of 2 m by 1 m."""
    root = tmp_path_factory.mktemp("tables")

    @cache
    def make(name: str) -> Path:
        folder = root / name.replace(" ", "_")
        seconds = 40.0 if name in LOCAL else 30.0
        make_recording(folder, LAWS[name], "launches", list(LAWS).index(name), seconds, camera=CAMERA, dt=5e-5)
        meta = json.loads((folder / "meta.json").read_text())
        meta["table"] |= {"length_m": 2.0, "width_m": 1.0}
        (folder / "meta.json").write_text(json.dumps(meta))
        return folder

    return make


def _diagnosis(recordings, heldout=()):
    training, holdout = ([read_recording(folder) for folder in folders] for folders in (recordings, heldout))
    return diagnose(training, holdout, {}, lambda stage, share: None)


@pytest.mark.slow
@pytest.mark.parametrize(
    "one, other",
    [
        ("plain", "tilted"),
        pytest.param("tilted", "tilted back", marks=pytest.mark.long),
        pytest.param("plain", "slick", marks=pytest.mark.long),
        pytest.param("plain", "lively", marks=pytest.mark.long),
        pytest.param("patched", "plain", marks=pytest.mark.long),
        pytest.param("plain", "whirling", marks=pytest.mark.long),
        pytest.param("tilted", "whirling", marks=pytest.mark.long),
        ("plain", "large"),
    ],
)
def test_two_tables_are_undetermined(recorded, one, other):
    found = _diagnosis([recorded(one), recorded(other)])
    assert (found.verdict, found.findings) == ("undetermined", [])
    assert found.reason and found.next_recording


@pytest.mark.slow
def test_a_holdout_of_another_table_contradicts_the_findings(recorded):
    found = _diagnosis([recorded("tilted")], [recorded("plain")])
    assert [one.mechanism for one in found.findings] == ["table_tilt"]
    assert any(remark.startswith("glide: the holdout contradicts the findings") for remark in found.proof_remarks)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name, mechanism", [("tilted", "table_tilt"), pytest.param("whirling", "unlisted", marks=pytest.mark.long)]
)
def test_two_recordings_of_one_table_agree(recorded, name, mechanism):
    found = _diagnosis([recorded(name), recorded(f"{name} again")])
    assert [one.mechanism for one in found.findings] == [mechanism]


@pytest.mark.long
@pytest.mark.parametrize("missing", ["side_force", "mallet_give", "wall_to_wall_restitution", "scale_error"])
def test_what_is_missing_in_both_is_no_other_table(tmp_path, missing):
    """Two recordings of one table, of 30 s and 15 s; the effect may be larger in one of them, or differ by launch."""
    cases = (draw_case(54, number, "one", None) for number in count())
    case = next(one for one in cases if one.truth["mechanisms"] == [missing])
    for seed, (name, seconds) in enumerate((("long", 30.0), ("short", 15.0))):
        make_recording(
            tmp_path / name, case.law, case.scenario, seed, seconds, case.camera,
            encoder_noise=case.encoder_noise, hand=case.hand, dt=1e-4,
        )  # fmt: skip
    found = _diagnosis([tmp_path / "long", tmp_path / "short"])
    assert "not of one table" not in (found.reason or "")


@pytest.mark.slow
@pytest.mark.parametrize("name, agrees", [("plain", True), ("tilted", False)])
def test_a_recording_too_small_for_a_law_is_compared_with_the_other(recorded, tmp_path, name, agrees):
    make_recording(tmp_path / "short", LAWS[name], "launches", 77, 8.0, camera=CAMERA, dt=1e-4)
    recordings = [read_recording(folder) for folder in (recorded("plain"), tmp_path / "short")]
    values = parameters(recordings[0])
    cuts = [glide_data(segment(one), geometry(one), {}) for one in recordings]
    problem = GlideProblem(join(cuts), values)
    parts = [
        RecordingPart(name, np.unique(problem.data.cluster[problem.data.recording == k]))
        for k, name in enumerate(("long", "short"))
    ]
    assert len(parts[1].clusters) < CONSISTENCY.fewest_launches
    with nullcontext() if agrees else pytest.raises(UndeterminedError, match="long and short are not of one table"):
        check_consistency(problem, {name: values[name] for name in problem.base}, parts)


@pytest.mark.slow
def test_a_robot_s_recording_beside_one_without_keeps_its_result(tmp_path):
    """Two recordings of one table, one of the robot alone and one of the puck alone; and the robot's as a proof."""
    make_recording(tmp_path / "robot", Law(voltage_sag=0.02), "gantry", 3, 14.0, dt=1e-4)
    make_recording(tmp_path / "puck", Law(), "launches", 4, 10.0, camera=CAMERA, dt=1e-4)
    found = _diagnosis([tmp_path / "puck", tmp_path / "robot"])
    assert [one.mechanism for one in found.findings] == ["voltage_sag"]
    alone = _diagnosis([tmp_path / "puck"], [tmp_path / "robot"])
    assert "gantry" not in {each.regime for each in alone.regime_results}  # the holdout finds nothing


def test_stated_sizes_of_two_tables_are_refused_in_one_line(recorded, tmp_path, capsys):
    make_recording(tmp_path / "longer", Law(length=2.2), "launches", 3, 10.0, camera=CAMERA, dt=5e-5)
    words = ["diagnose", str(recorded("plain")), str(tmp_path / "longer"), "--out", str(tmp_path / "out")]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "plain states table.length_m 2, longer 2.2" in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize(
    ("losses", "unexplained"),
    [
        ([4.0, 200.0, 4.0, 4.0, 4.0, 4.0], False),
        ([4.0, 200.0, 200.0, 4.0, 4.0, 4.0], True),
        ([200.0, 4.0], True),
        ([4.0, 4.0], False),
    ],
    ids=["one disturbed launch", "two", "one of a few", "none"],
)
def test_a_single_disturbed_launch_makes_no_other_table(monkeypatch, losses, unexplained):
    problem = SimpleNamespace(freedom=np.full(len(losses), 6.0))
    monkeypatch.setattr(consistency, "_own_loss", lambda fits, found, some: float(np.array(losses)[some].sum()))
    assert consistency._is_unexplained(consistency._Fits(problem), None, np.arange(len(losses))) is unexplained


class MeasuredOften:
    """A problem in which each launch measures a wall's restitution e six times, in units of its noise. Launches of ten
    of the first recording say 0.7; `second`: what each of the second's says, by e, zero where it agrees."""

    regime, base, NAME = "wall", ("wall_restitution",), "wall_restitution"

    def __init__(self, *second):
        self.says = [lambda e: 3e3 * (e - 0.7)] * 10 + list(second)
        self.clusters = len(self.says)
        self.freedom = np.full(self.clusters, 6.0)
        self.units = Units(np.arange(self.clusters), self.freedom)

    def residuals(self, values, free, clusters):
        e, which = values[self.NAME], np.repeat(clusters, 6)
        r = np.array([self.says[k](e) for k in which])
        slopes = np.array([(self.says[k](e + 1e-6) - self.says[k](e - 1e-6)) / 2e-6 for k in which])
        return Residuals(r, slopes[:, None] if free else np.zeros((len(r), 0)), which, which)


def vague(e):
    return 3.0 * (e - 0.7)


def disturbed(e):
    return 3e3 * (e - 0.9)


def agrees_twice(e):
    return 3e3 * (e - 0.7) * (e - 0.9)


@pytest.mark.parametrize(
    ("second", "start", "differ"),
    [
        ([disturbed, *[vague] * 9], 0.7, False),
        ([disturbed, disturbed, *[vague] * 8], 0.7, True),
        ([disturbed] * 10, 0.7, True),
        ([agrees_twice] * 10, 0.9, False),
        ([vague] * 10, 0.7, False),
    ],
    ids=["one disturbed launch", "two", "another table", "a fit that starts in another minimum", "none"],
)
def test_parameters_are_of_two_tables_only_where_no_fit_and_no_single_launch_explains_it(second, start, differ):
    problem = MeasuredOften(*second)
    parts = [RecordingPart("one", np.arange(10)), RecordingPart("other", np.arange(10, problem.clusters))]
    law = SimpleNamespace(values={problem.NAME: start}, free=(problem.NAME,))
    found = consistency._differ_in_parameters(consistency._Fits(problem), SimpleNamespace(law=law), parts)
    assert bool(found) is differ


@pytest.mark.parametrize(
    ("shared", "differ"), [(0.9, False), (1.6, True)], ids=["explained to the noise", "more than the noise"]
)
def test_a_smooth_term_that_explains_both_to_the_noise_makes_no_two_tables(monkeypatch, shared, differ):
    """Each alone leaves a third of what a common term does: with errors that persist from sample to sample much of the
    noise is fitted, too."""
    problem = SimpleNamespace(freedom=np.full(20, 50.0), regime="gantry")
    parts = [RecordingPart("one", np.arange(10)), RecordingPart("other", np.arange(10, 20))]

    def losses(problem, found, clusters):
        left = np.zeros(20)
        left[clusters] = 50.0 * (shared if len(clusters) == 20 else shared / 3.0)
        return left

    monkeypatch.setattr(consistency, "_losses", losses)
    found = SimpleNamespace(dispersion=1.0)
    assert bool(consistency._differ_in_smooth_term(problem, found, parts)) is differ
