"""table.json and camera.json: what is written is read, what is broken is named, and nothing is half written."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from sim2real.vision.calibrate.multiview import solve
from sim2real.vision.calibrate.table_file import FORMAT, TableCalibration, read_table, write_table
from sim2real.vision.camera_file import read_setup, write_camera
from sim2real.vision.track.tracker import Targets, Tracker
from tests.sim2real.vision import world
from tests.sim2real.vision.calibrate.test_multiview import SETUP, fit, view
from tests.sim2real.vision.test_camera import CAMERA


@pytest.fixture
def table(tmp_path: Path) -> Path:
    write_table(tmp_path / "table.json", SETUP, fit())
    return tmp_path / "table.json"


def test_a_table_is_read_as_it_was_written(table: Path):
    found = read_table(table)
    assert found.setup == SETUP
    assert list(found.geometry.markers) == list(fit().geometry.markers)
    np.testing.assert_array_equal(found.geometry.vector(), fit().geometry.vector())
    assert found.geometry.warp.box == fit().geometry.warp.box
    assert found.place_std == TableCalibration.of(SETUP, fit()).place_std and 5e-5 < found.place_std < 1e-3
    assert [path.name for path in table.parent.iterdir()] == ["table.json"]


def test_the_file_says_how_far_off_each_point_was(table: Path):
    words = json.loads(table.read_text())
    assert words["format"] == FORMAT == "puckpilot-table/1"
    off = [point["off_m"] for view in words["views"] for point in view["points"]]
    np.testing.assert_array_equal(off, np.concatenate(fit().off))
    assert all(len(one["corners_m"]) == 4 and min(map(min, one["std"])) > 0.0 for one in words["markers"])


def test_it_states_standard_deviations_and_which_points_are_wrong(tmp_path: Path):
    """As the fit's own words, of a view in which one point was measured 8 mm wrong."""
    bad = view(1)
    places = bad.places.copy()
    places[7] += (0.0, 0.008)
    found = solve(SETUP, (view(0), replace(bad, places=places)))
    write_table(tmp_path / "table.json", SETUP, found)
    words = json.loads((tmp_path / "table.json").read_text())
    wrong = [(one["name"], k) for one in words["views"] for k, point in enumerate(one["points"]) if point["wrong"]]
    assert wrong == [("view_1", 7)]
    stated = [words["surface"]["std"], words["frame"]["std"], *(np.ravel(one["std"]) for one in words["markers"])]
    np.testing.assert_allclose(np.concatenate(stated) ** 2, np.diag(found.geometry_covariance()), rtol=1e-9)


@pytest.mark.parametrize("goal", [None, 0.34])
def test_a_goals_width_comes_into_recordings_if_it_is_known(tmp_path: Path, goal: float | None):
    write_table(tmp_path / "table.json", replace(SETUP, goal_width=goal), fit())
    found = read_table(tmp_path / "table.json")
    assert found.setup.goal_width == goal
    table = Tracker(found, Targets(0.031, 0.02, 75.0)).recording("seen", "").meta["table"]
    assert table == {"length_m": world.LENGTH, "width_m": world.WIDTH, "goal_width_m": goal}


def test_a_table_that_does_not_speak_of_goals_is_read(table: Path):
    words = json.loads(table.read_text())
    del words["table"]["goal_width_m"]
    table.write_text(json.dumps(words))
    assert read_table(table).setup == SETUP


def put(words: object, keys: list, value: object) -> None:
    """Into objects and lists, by the way there."""
    for key in keys[:-1]:
        words = words[key]  # pyright: ignore[reportIndexIssue]
    words[keys[-1]] = value  # pyright: ignore[reportIndexIssue]


@pytest.mark.parametrize(
    "keys, value, message",
    [
        (["table", "length_m"], 1000, '"length_m" is 1000; expected a number from 0.3 to 5 metres'),
        (
            ["surface", "xx_xy_yy_per_m"],
            [0, 0, 4.0],
            '"xx_xy_yy_per_m" holds 4; expected 3 numbers from -0.1',
        ),
        (["surface", "middle_m"], [1000, 500], '"middle_m" holds 1000; expected 2 numbers from -3 to 8 metres'),
        (["frame", "box_m"], [[0, 0], [0, 0]], r'"box_m" is \[\[0.0, 0.0\], .*expected its least x and y, then'),
        (["frame", "bend_m", 2], 0.6, '"bend_m" holds 0.6; expected 38 numbers from -0.05 to 0.05 metres'),
        (
            ["markers", 0, "corners_m", 1],
            [300, -90, 10],
            '"corners_m" holds 300; expected 4 by 3 numbers from -3 to 8 metres',
        ),
        (["markers", 0, "corners_m"], [[1, 1, 0]] * 4, "marker 0 twice or with sides of 0 to 0 m; expected each once"),
        (["markers", 0, "id"], 1, "has marker 1 twice or with sides of 0.0"),
        (["aruco_dictionary"], None, '"aruco_dictionary" is None; expected a name'),
        (["camera", "distortion_k1_k2_p1_p2_k3", 0], -9.0, "folds the picture over"),
    ],
)
def test_a_table_that_cannot_be_is_named(table: Path, keys: list, value: object, message: str):
    words = json.loads(table.read_text())
    put(words, keys, value)
    table.write_text(json.dumps(words))
    with pytest.raises(ValueError, match=f"^{table}: .*{message}"):
        read_table(table)


@pytest.mark.parametrize(
    "key, value, message",
    [
        ("format", "puckpilot-table/2", "format is 'puckpilot-table/2'; expected a calibration of format"),
        ("markers", None, '"markers" is no list of objects'),
        ("surface", 3, '"surface" is missing or no object'),
        ("frame", {"axis_i_j": []}, "the terms of the frame's warp are others"),
        (
            "puck_top_above_table_m",
            "high",
            "\"puck_top_above_table_m\" is 'high'; expected a number from 0 to 0.03 metres",
        ),
        ("camera", {"K": [[1, 2], [3, 4]]}, r'"K" is \[\[1, 2\], \[3, 4\]\]; expected 3 by 3 numbers'),
    ],
)
def test_a_broken_table_is_named(table: Path, key: str, value: object, message: str):
    table.write_text(json.dumps({**json.loads(table.read_text()), key: value}))
    with pytest.raises(ValueError, match=message):
        read_table(table)


def test_a_setup_is_read(tmp_path: Path):
    assert read_setup(world.write_camera_file(tmp_path / "camera.json")).camera.distortion == CAMERA.distortion


@pytest.mark.parametrize(
    "change, message",
    [
        ({"K": [[1640, 1, 1018], [0, 1639, 772], [0, 0, 1]]}, r'"K" is .* expected \[\[fx, 0, cx\]'),
        ({"K": [[1640, 0, float("nan")], [0, 1639, 772], [0, 0, 1]]}, '"K" holds nan; expected 3 by 3 numbers'),
        ({"table": {"length_m": 2362, "width_m": 1144}}, '"length_m" is 2362; expected a number from 0.3 to 5 metres'),
        ({"table": {"length_m": 2.3, "width_m": 10**400}}, '"width_m" is 1000+; expected a number from'),
        ({"table": {"length_m": 2.3, "width_m": "1.144"}}, "\"width_m\" is '1.144'; expected a number from"),
        ({"table": {"length_m": 2.3, "width_m": True}}, '"width_m" is True; expected a number from'),
        ({"table": {"length_m": 2.3}}, '"width_m" is missing; expected a number from'),
        (
            {"table": {"length_m": 2.3, "width_m": 1.1, "goal_width_m": 1.2}},
            '"goal_width_m" is 1.2; expected a number from 0.05 to 1.1 metres',
        ),
        ({"puck_top_above_table_m": 0.0585}, '"puck_top_above_table_m" is 0.0585; expected a number from 0 to 0.03 m'),
        ({"aruco_dictionary": "FOO"}, "\"aruco_dictionary\": unknown dictionary of markers 'FOO'; expected one"),
        ({"image_size_px": [0, 1536]}, '"image_size_px" holds 0; expected 2 numbers from 16 to'),
        ({"distortion_k1_k2_p1_p2_k3": [1e30] * 5}, r'k3" holds 1e\+30; expected 5 numbers from -1000 to 1000'),
        ({"distortion_k1_k2_p1_p2_k3": [-9.0, 0, 0, 0, 0]}, r'k3" is \[-9.0, .*folds the picture over'),
        ({"distortion_k1_k2_p1_p2_k3": [[0.1] * 2, 0, 0, 0, 0]}, "expected 5 numbers"),
        ({"table": {"length_m": None, "width_m": 1.0}}, '"length_m" is None; expected a number'),
        ({"table": None}, '"table" is None; expected an object with length_m and width_m'),
        ({"aruco_dictionary": None}, '"aruco_dictionary" is None; expected a name'),
        ({"distortion_k1_k2_p1_p2_k3": [0, 0]}, "expected 5 numbers"),
    ],
)
def test_a_broken_setup_is_named(tmp_path: Path, change: dict, message: str):
    path = tmp_path / "camera.json"
    path.write_text(json.dumps({**world.camera_fields(), **change}))
    with pytest.raises(ValueError, match=message):
        read_setup(path)


def test_what_is_no_json_is_named(tmp_path: Path):
    path = tmp_path / "camera.json"
    with pytest.raises(ValueError, match=r"cannot read .*camera\.json: No such file"):
        read_setup(path)
    path.write_text("{")
    with pytest.raises(ValueError, match="not JSON"):
        read_setup(path)
    path.write_text('\ufeff{"K": 1, "table": {"width_m": 1, "width_m": 2}}', encoding="utf-8")  # begun as Windows may
    with pytest.raises(ValueError, match=r'camera\.json: "width_m" is given twice; expected once'):
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
