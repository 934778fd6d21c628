"""`puckpilot calibrate table` from files to files, on traced photographs and on the real table's."""

from __future__ import annotations

import json
import shutil
from pathlib import Path

import numpy as np
import pytest

import puckpilot
from sim2real.vision.calibrate.calibration_view import read_view
from sim2real.vision.calibrate.holdout_view import check_holdout
from sim2real.vision.calibrate.table_file import read_table
from tests.places import UBC
from tests.sim2real.vision import world

pytestmark = pytest.mark.slow

CALIBRATION = UBC / "calibration"


@pytest.fixture(scope="module")
def made(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder of camera.json and four views, places known to 0.3 mm; one point of the second is 5 mm off."""
    folder = tmp_path_factory.mktemp("made")
    world.write_camera_file(folder / "camera.json")
    for k, place in enumerate(world.CAMERA_PLACES):
        motion, rng = world.camera_motion(place), np.random.default_rng(k)
        pixels = world.seen(motion, world.puck_points(world.grid())) + rng.normal(0.0, 0.1, (36, 2))
        places = world.grid() + rng.normal(0.0, 3e-4, (36, 2))
        places[7] += np.array([0.003, 0.004]) * (k == 1)
        world.write_view(folder / f"view_{k}", world.photograph(motion), pixels, places)
    return folder


def calibrated(folder: Path, views: list[str], check: str | None, out: Path, capsys) -> dict:
    """What the command says in JSON."""
    words = ["calibrate", "table", *(str(folder / name) for name in views), "--camera", str(folder / "camera.json")]
    words += ["--out", str(out), "--json", *([] if check is None else ["--check", str(folder / check)])]
    assert puckpilot.main(words) == 0
    return json.loads(capsys.readouterr().out)


def test_a_made_up_table_is_found(made: Path, tmp_path: Path, capsys):
    found = calibrated(made, ["view_0", "view_1", "view_2"], "view_3", tmp_path / "table.json", capsys)
    assert found["check"] == "view_3" and found["markers"] == 6 and found["fit"]["points"] == 108
    assert found["median_mm"] <= found["mean_mm"] < 0.6 and found["max_mm"] < 1.5
    assert [(one["view"], one["point"]) for one in found["wrong"]] == [("view_1", 8)]
    assert found["wrong"][0]["off_mm"] == pytest.approx(5.0, abs=0.8)
    assert max(found["corner_rms_px"]) < 0.05 and not found["step_across"]["clear"] and not found["weakest"]["matters"]
    for k, one in enumerate(found["surface_per_m"].values()):
        assert abs(one["value"] - world.CURVATURE[k]) < 4.0 * one["std"]
    words, table = json.loads((tmp_path / "table.json").read_text()), read_table(tmp_path / "table.json")
    far = [1e3 * np.hypot(*point["off_m"]) for view in words["views"] for point in view["points"]]
    assert found["fit"] == {"points": 108, "mean_mm": pytest.approx(np.mean(far)), "max_mm": pytest.approx(max(far))}
    far = 1e3 * np.hypot(*check_holdout(table.setup, table.geometry, read_view(made / "view_3", table.setup)).off.T)
    figures = [found["mean_mm"], found["median_mm"], found["max_mm"], found["farthest_point"]]
    assert figures == pytest.approx([far.mean(), np.median(far), far.max(), far.argmax() + 1])
    markers = table.geometry.markers
    off = [np.abs(markers[name] - corners).max() for name, corners in world.markers().items()]
    assert max(off) < 4e-3
    assert sorted(path.name for path in tmp_path.iterdir()) == ["table.json", "table.png"]
    assert (tmp_path / "table.png").read_bytes()[:4] == b"\x89PNG"


def test_it_says_so_in_words(made: Path, tmp_path: Path, capsys):
    words = ["calibrate", "table", *(str(made / f"view_{k}") for k in range(2)), "--camera", str(made / "camera.json")]
    assert puckpilot.main([*words, "--out", str(tmp_path / "t.json"), "--check", str(made / "view_2")]) == 0
    found = capsys.readouterr().out
    assert "2 views, 6 markers, 72 points in " in found and "wrong measurement: view_1, point 8, " in found
    assert "check on view_2, not used: mean 0." in found and f"{tmp_path / 't.png'} shows it" in found


@pytest.mark.parametrize("again", [["view_0/../view_1"], ["copy"], ["--check", "view_1"], ["--check", "copy"]])
def test_a_view_that_is_given_twice_is_refused(made: Path, tmp_path: Path, again: list[str], capsys):
    shutil.copytree(made / "view_1", made / "copy", dirs_exist_ok=True)
    views = [word if word.startswith("--") else str(made / word) for word in ["view_0", "view_1", *again]]
    words = ["--camera", str(made / "camera.json"), "--out", str(tmp_path / "t.json")]
    assert puckpilot.main(["calibrate", "table", *views, *words]) == 2
    found = capsys.readouterr().err
    assert f"{made / again[-1]} shows the same photograph as {made / 'view_1'}; give each once" in found
    assert not list(tmp_path.iterdir())


def test_a_check_that_cannot_be_leaves_no_file(made: Path, tmp_path: Path, capsys):
    shutil.copytree(made / "view_2", made / "mistyped")
    rows = np.loadtxt(made / "mistyped" / "pixels.csv", delimiter=",", skiprows=1)
    rows[4, 2] += 0.4
    np.savetxt(made / "mistyped" / "pixels.csv", rows, delimiter=",", header="u,v,x,y", comments="", fmt="%.6f")
    words = [str(made / "view_0"), str(made / "view_1"), "--camera", str(made / "camera.json")]
    words += ["--out", str(tmp_path / "t.json"), "--check", str(made / "mistyped")]
    assert puckpilot.main(["calibrate", "table", *words]) == 2
    assert "mistyped: not seen where measured: point 5 (" in capsys.readouterr().err and not list(tmp_path.iterdir())


def test_a_table_that_is_not_covered_is_reported(made: Path, tmp_path: Path, capsys):
    for k in range(2):
        shutil.copytree(made / f"view_{k}", made / f"near_{k}")
        lines = (made / f"near_{k}" / "pixels.csv").read_text().splitlines()
        (made / f"near_{k}" / "pixels.csv").write_text("\n".join(lines[:19]) + "\n")
    words = [str(made / "near_0"), str(made / "near_1"), "--camera", str(made / "camera.json")]
    assert puckpilot.main(["calibrate", "table", *words, "--out", str(tmp_path / "t.json")]) == 0
    found = capsys.readouterr().out
    assert "the table is not covered: at (2.00, " in found and " m from any point, places are known to " in found


def test_the_picture_does_not_take_the_tables_place(made: Path, tmp_path: Path, capsys):
    words = [str(made / "view_0"), str(made / "view_1"), "--camera", str(made / "camera.json")]
    assert puckpilot.main(["calibrate", "table", *words, "--out", str(tmp_path / "t.png")]) == 2
    assert "t.png'; expected a name that ends in .json" in capsys.readouterr().err and not list(tmp_path.iterdir())


@pytest.fixture
def real() -> Path:
    if not CALIBRATION.exists():
        pytest.skip(f"no photographs of the real table beside the project ({CALIBRATION})")
    return CALIBRATION


@pytest.mark.parametrize("kept", [1, 2, 3])
def test_the_real_table_each_view_by_the_others(real: Path, kept: int, tmp_path: Path, capsys):
    """Leave-one-out on real photographs. The largest errors of view 2 are of the points that the other two, together
    with it, show to be measured wrong."""
    views = [f"view_{k}" for k in (1, 2, 3) if k != kept]
    found = calibrated(real, views, f"view_{kept}", tmp_path / "table.json", capsys)
    with capsys.disabled():
        print(
            f"\nview_{kept}: mean {found['mean_mm']:.2f}, median {found['median_mm']:.2f}, max {found['max_mm']:.2f} mm"
        )
    assert found["mean_mm"] < 0.7 and found["median_mm"] < 0.6
    assert found["max_mm"] < {1: 1.8, 2: 2.6, 3: 1.5}[kept]


def test_the_real_tables_wrong_points_and_width_are_named(real: Path, tmp_path: Path, capsys):
    found = calibrated(real, ["view_1", "view_2", "view_3"], None, tmp_path / "table.json", capsys)
    assert [(one["view"], one["point"]) for one in found["wrong"]] == [("view_2", 3), ("view_2", 27)]
    assert found["step_across"]["clear"] and found["step_across"]["mm"] == pytest.approx(2.6, abs=0.4)
    assert max(found["corner_rms_px"]) < 0.2
