"""A physical table that is not opened: what its file, its calibration and the game must agree on."""

from __future__ import annotations

from contextlib import closing
from pathlib import Path

import numpy as np
import pytest

from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.scene_state import SceneState
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.settings import CameraSettings
from sim2real.table.faults import TableFaultError
from sim2real.table.game.robot_seat import make_robot_seat
from sim2real.table.physical import physical_table
from sim2real.table.physical.physical_table import live_eyes
from sim2real.table.physical.table_file import read_table_file
from sim2real.table.twin.rendered_table import RenderedTable

RENDERED = RenderedTable(Table.with_markers(), CameraView.like_the_real_one(2.0, 1.0))  # 2 m by 1 m
FILE = """
format = "puckpilot-table/1"
[parameters]
{parameters}
[camera]
source = "device:0"
calibration = "table.json"
{setup}
[board]
port = "/dev/ttyUSB0"
supply = 20.0
"""


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    monkeypatch.setattr(physical_table, "read_table", lambda path: RENDERED.calibration())
    return tmp_path


def written(folder: Path, parameters: str, setup: str = "") -> Path:
    (folder / "table.toml").write_text(FILE.format(parameters=parameters, setup=setup))
    return folder / "table.toml"


def test_the_tables_file_states_the_parameters(folder: Path) -> None:
    with closing(make_robot_seat("match-v0", "table", table=written(folder, "friction = 0.1"))) as seat:
        assert [float(seat.game.p[name]) for name in ("friction", "max_voltage", "length")] == [0.1, 20.0, 2.0]


@pytest.mark.parametrize(
    ("parameters", "given", "words"),
    [
        ("length = 1.9", None, r"table.json is of a table of length 2 m, the game's is 1\.9 m; state length under"),
        ("width = 1.02", None, r"of width 1 m, the game's is 1\.02 m"),
        ("", {"max_voltage": 24.0}, r"the table's file has max_voltage 20, the game 24; give parameters="),
    ],
)
def test_what_does_not_agree_is_refused_in_one_line(
    folder: Path, parameters: str, given: dict | None, words: str
) -> None:
    with pytest.raises(ValueError, match=words) as error:
        make_robot_seat("match-v0", "table", parameters=given, table=written(folder, parameters))
    assert "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("content", "words"),
    [
        (None, "cannot read {file}: No such file or directory; expected a picture there"),
        (b"no picture", "{file} cannot be read as a picture; expected one"),
    ],
)
def test_a_setup_picture_that_cannot_be_read_is_refused_in_one_line(
    folder: Path, content: bytes | None, words: str, capfd: pytest.CaptureFixture[str]
) -> None:
    file = folder / "setup.png"
    if content is not None:
        file.write_bytes(content)
    with pytest.raises(ValueError) as error:
        make_robot_seat("match-v0", "table", table=written(folder, "", 'setup = "setup.png"'))
    assert str(error.value).startswith(words.format(file=file)) and "\n" not in str(error.value)
    assert not capfd.readouterr().err


def test_a_setup_picture_is_taken_when_the_camera_is_opened(folder: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    taken: list[tuple] = []
    empty_table = Renderer(RENDERED.table, RENDERED.view).picture(SceneState(0.0, None, None, None), 0)

    def take(word: str, settings: CameraSettings, sensor: tuple[int, int]) -> np.ndarray:
        taken.append((word, settings.setup_exposure, sensor))
        return empty_table if len(taken) > 1 else np.zeros_like(empty_table)

    monkeypatch.setattr(physical_table, "take_setup_picture", take)
    opened: list[CameraSettings] = []
    monkeypatch.setattr(physical_table, "open_source", lambda word, settings: opened.append(settings))
    camera = read_table_file(written(folder, "", "setup_exposure = 8e-3")).camera
    with pytest.raises(TableFaultError, match=r"the camera cannot be located in the setup picture: "):
        live_eyes(camera)
    live_eyes(camera)
    assert taken == [("device:0", 8e-3, RENDERED.calibration().setup.camera.size)] * 2
    assert [settings.setup_exposure for settings in opened] == [None]
