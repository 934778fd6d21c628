"""table.json and camera.json: what is written is read, what is broken is named, and nothing is half written."""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest

from sim2real.vision.calibrate.table_file import FORMAT, read_table, write_table
from sim2real.vision.camera_file import read_setup, write_camera
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_multiview import SETUP, solved
from tests.sim2real.vision.test_camera import CAMERA


@pytest.fixture
def table(tmp_path: Path) -> Path:
    write_table(tmp_path / "table.json", SETUP, solved())
    return tmp_path / "table.json"


def test_a_table_is_read_as_it_was_written(table: Path):
    found = read_table(table)
    assert found.setup == SETUP
    assert list(found.scene.markers) == list(solved().scene.markers)
    np.testing.assert_array_equal(found.scene.vector(), solved().scene.vector())
    assert found.scene.bend.box == solved().scene.bend.box
    assert [path.name for path in table.parent.iterdir()] == ["table.json"]


def test_the_file_says_how_far_off_each_point_was(table: Path):
    words = json.loads(table.read_text())
    assert words["format"] == FORMAT == "puckpilot-table/1"
    off = [point["off_m"] for view in words["views"] for point in view["points"]]
    np.testing.assert_array_equal(off, np.concatenate(solved().off))
    assert all(len(one["corners_m"]) == 4 and min(map(min, one["std"])) > 0.0 for one in words["markers"])


@pytest.mark.parametrize(
    "key, value, told",
    [
        ("format", "puckpilot-table/2", "format is 'puckpilot-table/2'; expected a calibration of format"),
        ("markers", None, '"markers" is no list of objects'),
        ("surface", 3, '"surface" is missing or no object'),
        ("frame", {"axis_i_j": []}, "the terms of the frame's bend are others"),
        ("puck_top_above_table_m", "high", '"puck_top_above_table_m" is high; expected a number'),
        ("camera", {"K": [[1, 2], [3, 4]]}, r'"K" is \[\[1, 2\], \[3, 4\]\]; expected 3 by 3 numbers'),
    ],
)
def test_a_broken_table_is_named(table: Path, key: str, value: object, told: str):
    table.write_text(json.dumps({**json.loads(table.read_text()), key: value}))
    with pytest.raises(ValueError, match=told):
        read_table(table)


def test_a_setup_is_read(tmp_path: Path):
    assert read_setup(world.write_camera_file(tmp_path / "camera.json")).camera.distortion == CAMERA.distortion


@pytest.mark.parametrize(
    "change, told",
    [
        ({"K": [[1640, 1, 1018], [0, 1639, 772], [0, 0, 1]]}, r'"K" is .* expected \[\[fx, 0, cx\]'),
        ({"K": [[1640, 0, float("nan")], [0, 1639, 772], [0, 0, 1]]}, '"K" is .*; expected 3 by 3 numbers'),
        ({"table": {"length_m": 2362, "width_m": 1144}}, "table 2362 by 1144 m .* expected metres"),
        ({"table": {"length_m": None, "width_m": 1.0}}, '"length_m" is None; expected a number'),
        ({"table": None}, '"table" is None; expected an object with length_m and width_m'),
        ({"aruco_dictionary": None}, '"aruco_dictionary" is None; expected a name'),
        ({"distortion_k1_k2_p1_p2_k3": [0, 0]}, "expected 5 numbers"),
    ],
)
def test_a_broken_setup_is_named(tmp_path: Path, change: dict, told: str):
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({**world.camera_words(), **change}))
    with pytest.raises(ValueError, match=told):
        read_setup(path)


def test_what_is_no_json_is_named(tmp_path: Path):
    path = tmp_path / "camera.json"
    with pytest.raises(ValueError, match=r"cannot read .*camera\.json: No such file"):
        read_setup(path)
    path.write_text("{")
    with pytest.raises(ValueError, match="not JSON"):
        read_setup(path)
    path.write_text("[]")
    with pytest.raises(ValueError, match="holds no JSON object"):
        read_setup(path)


def test_a_camera_keeps_its_numbers(tmp_path: Path):
    path = tmp_path / "camera.json"
    write_camera(path, CAMERA, "made up")
    words = json.loads(path.read_text())
    assert words["table"] == {"length_m": None, "width_m": None, "goal_width_m": None}
    words |= {
        "aruco_dictionary": "DICT_4X4_50",
        "table": {"length_m": 2.0, "width_m": 1.0},
        "puck_top_above_table_m": 0.006,
    }
    path.write_text(json.dumps(words))
    assert read_setup(path) == SETUP
