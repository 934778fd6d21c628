"""Several recordings in one call: of one table they help each other, of two they name nothing."""

import json
from functools import cache
from pathlib import Path

import pytest

from puckpilot import main
from sim2real.diagnose.diagnosis import diagnose
from sim2real.recording import read_recording
from tests.reality.camera import Camera
from tests.reality.law import Law
from tests.reality.record import make_recording

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


@pytest.fixture(scope="module")
def recorded(tmp_path_factory):
    """Makes the recording of a table of LAWS, once; each by another hand. All state a table of 2 m by 1 m."""
    root = tmp_path_factory.mktemp("tables")

    @cache
    def make(name: str) -> Path:
        folder = root / name.replace(" ", "_")
        make_recording(folder, LAWS[name], "launches", list(LAWS).index(name), 40.0, camera=CAMERA, dt=2e-5)
        meta = json.loads((folder / "meta.json").read_text())
        meta["table"] |= {"length_m": 2.0, "width_m": 1.0}
        (folder / "meta.json").write_text(json.dumps(meta))
        return folder

    return make


def _diagnosis(recordings, heldout=()):
    here, apart = ([read_recording(folder) for folder in folders] for folders in (recordings, heldout))
    return diagnose(here, apart, {}, lambda stage, share: None)


@pytest.mark.parametrize(
    "one, other",
    [
        ("plain", "tilted"),
        ("tilted", "tilted back"),
        ("plain", "slick"),
        ("plain", "lively"),
        ("patched", "plain"),
        ("plain", "whirling"),
        ("tilted", "whirling"),
        ("plain", "large"),
    ],
)
def test_two_tables_name_nothing(recorded, one, other):
    found = _diagnosis([recorded(one), recorded(other)])
    assert (found.verdict, found.findings) == ("undetermined", [])
    assert found.reason and found.next_recording


def test_a_held_out_recording_of_another_table_names_nothing(recorded):
    found = _diagnosis([recorded("tilted")], [recorded("plain")])
    assert (found.verdict, found.findings) == ("undetermined", [])
    assert "disagree as two tables do" in found.reason


@pytest.mark.parametrize("name, mechanism", [("tilted", "table_tilt"), ("whirling", "unlisted")])
def test_two_recordings_of_one_table_agree(recorded, name, mechanism):
    found = _diagnosis([recorded(name), recorded(f"{name} again")])
    assert [one.mechanism for one in found.findings] == [mechanism]


def test_stated_sizes_of_two_tables_are_refused_in_one_line(recorded, tmp_path, capsys):
    make_recording(tmp_path / "longer", Law(length=2.2), "launches", 3, 10.0, camera=CAMERA, dt=2e-5)
    words = ["diagnose", str(recorded("plain")), str(tmp_path / "longer"), "--out", str(tmp_path / "out")]
    assert main(words) == 2
    error = capsys.readouterr().err
    assert "plain states table.length_m 2, longer 2.2" in error and error.count("\n") == 1
    assert not (tmp_path / "out").exists()
