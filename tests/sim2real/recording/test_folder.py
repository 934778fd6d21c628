"""Recordings are read completely or refused by file, line and reason, and written completely or not at all."""

import json
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from sim2real.recording.folder import Recording, RecordingError, Stream, read_recording, write_recording
from tests.places import SHARED

META = {
    "format": "puckpilot-recording/1",
    "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": None},
    "puck": {"radius_m": 0.03},
    "mallet": {"radius_m": 0.05},
    "camera": {"rate_hz": 100.0, "position_std_m": None},
}
HEADER = "t,puck_x,puck_y,opponent_x,opponent_y\n"


def folder_with(path: Path, frames: str | bytes | None = None, meta=META, **others: str) -> Path:
    path.mkdir(exist_ok=True)
    (path / "meta.json").write_text(meta if isinstance(meta, str) else json.dumps(meta))
    if frames is not None:
        (path / "frames.csv").write_bytes(frames if isinstance(frames, bytes) else frames.encode())
    for name, text in others.items():
        (path / f"{name}.csv").write_text(text)
    return path


def rows(*lines: str) -> str:
    return HEADER + "".join(line + "\n" for line in lines)


def test_reads_blank_cells_as_not_seen_and_keeps_unknown_columns(tmp_path):
    text = "t,puck_x,puck_y,opponent_x,opponent_y,heat,who\n0,1.5,0.5,,,7,ann\n0.01,,,,,8,\n"
    found = read_recording(folder_with(tmp_path / "a", text))
    assert found.name == "a" and found.mallet is None and found.frames is not None
    np.testing.assert_array_equal(found.frames["puck_x"], [1.5, np.nan])
    assert found.frames["heat"].tolist() == [7.0, 8.0]
    assert found.frames["who"].tolist() == ["ann", ""]
    assert found.nominal("table", "goal_width_m") is None and found.nominal("puck", "radius_m") == 0.03


def test_a_header_alone_and_a_gantry_alone_are_recordings(tmp_path):
    found = read_recording(folder_with(tmp_path, HEADER, mallet="t,mallet_x,mallet_y\n0,0.2,0.5\n"))
    assert found.frames is not None and found.frames.rows == 0
    (tmp_path / "frames.csv").unlink()
    assert read_recording(tmp_path).frames is None


@pytest.mark.parametrize(
    ("frames", "line", "words"),
    [
        ("", 1, "empty"),
        ("t,puck_x\n0,1\n", 1, "puck_y, opponent_x, opponent_y is missing"),
        ("t,puck_x,puck_x,puck_y,opponent_x,opponent_y\n", 1, "twice"),
        (rows("0,1,0.5,,", "0.01,1,0.5,"), 3, "has 4 cells, expected 5"),
        (rows("0,1,0.5,,", "", "0.01,1,0.5,,"), 3, "has 0 cells"),
        (rows("0,1,0.5,,", "0.01,1,0.5,,", "0.01,1,0.5,,"), 4, "appears twice"),
        (rows("0,1,0.5,,", "0.02,1,0.5,,", "0.01,1,0.5,,"), 4, "goes back"),
        (rows("0,1,0.5,,", ",1,0.5,,"), 3, "t is blank"),
        (rows("0,1,0.5,,", "0.01,one,0.5,,"), 3, "'one'"),
        (rows("0,1,0.5,,", "0.01,nan,0.5,,"), 3, "'nan'"),
        (rows("0,1,0.5,,", "0.01,1,-inf,,"), 3, "'-inf'"),
        (rows("0,1,0.5,,", "0.01,1e400,0.5,,"), 3, "1e400"),
        (rows("0,1,0.5,,", "0.01,1e30,0.5,,"), 3, "1e+30"),
        (rows("0,1,0.5,,", "0.01,1_0,0.5,,"), 3, "1_0"),
        (rows("0,1,0.5,,", '0.01,"1,0.5,,'), 3, "CSV"),
        (rows("0,1,0.5,,").encode() + b"0.01,\xff,0.5,,\n", 3, "UTF-8"),
        (rows("0,1,0.5,,").encode("utf-16"), None, "zero bytes"),
        (b"\x89PNG\r\n\x1a\n\0\0", None, "binary"),
        (rows(*(f"{k},1,0.5,," for k in range(5))), None, "seconds"),
        (rows(*(f"{k / 100},{800 + k},500,," for k in range(5))), 2, "outside of the table of 2 x 1 m"),
    ],
)
def test_refuses_broken_frames_by_file_line_and_reason(tmp_path, frames, line, words):
    with pytest.raises(RecordingError) as error:
        read_recording(folder_with(tmp_path, frames))
    assert error.value.file.name == "frames.csv" and error.value.line == line
    assert words in str(error.value) and "\n" not in str(error.value)


@pytest.mark.parametrize(
    ("meta", "words"),
    [
        ("{", "not JSON"),
        ("[]", "one object"),
        ("[" * 100_000, "not usable"),
        (json.dumps(META | {"format": "other/1"}), "'other/1'"),
        (json.dumps({k: v for k, v in META.items() if k != "table"}), '"table"'),
        (json.dumps(META | {"puck": {"radius_m": "big"}}), 'puck.radius_m is "big"'),
        (json.dumps(META | {"puck": {"radius_m": True}}), "puck.radius_m"),
        (json.dumps(META | {"table": {"length_m": 2000}}), "table.length_m"),
        (json.dumps(META | {"gantry": {"supply_V": "24 V"}}), 'gantry.supply_V is "24 V"'),
        (json.dumps(META | {"gantry": 24}), '"gantry"'),
        (json.dumps(META | {"gantri": None}), "unknown key 'gantri'; did you mean 'gantry'?"),
        (json.dumps({k.replace("table", "tabel"): v for k, v in META.items()}), "did you mean 'table'?"),
        (json.dumps(META | {"colour": "blue"}), "unknown key 'colour'; known: format, table, puck"),
        (
            json.dumps(META | {"camera": {"rate_Hz": 100.0}}),
            "field of camera 'rate_Hz'; did you mean 'rate_hz'?",
        ),
        (
            json.dumps(META | {"table": {"length_m": 2.0, "lenght_m": 2.1}}),
            "'lenght_m'; did you mean 'length_m'?",
        ),
        (json.dumps(META).replace("100.0", "NaN"), "NaN"),
    ],
)
def test_refuses_broken_meta_data(tmp_path, meta, words):
    with pytest.raises(RecordingError, match=r"meta\.json") as error:
        read_recording(folder_with(tmp_path, HEADER, meta))
    assert words in str(error.value) and "\n" not in str(error.value)


def test_every_key_of_the_format_and_notes_are_read(tmp_path):
    known = {
        "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": 0.3, "note": "measured by hand"},
        "puck": {"radius_m": 0.03},
        "mallet": {"radius_m": 0.05},
        "camera": {"rate_hz": 100.0, "position_std_m": 0.001, "place_std_m": 0.0002},
        "gantry": {"supply_V": 24.0, "pulley_radius_m": 0.035, "supercapacitor": True},
        "note": "by hand",
        "notes": ["a", "b"],
    }
    assert read_recording(folder_with(tmp_path, HEADER, {"format": META["format"], **known})).meta == META | known


@pytest.mark.parametrize("gantry", [None, {}, {"supply_V": None, "pulley_radius_m": 0.03}])
def test_a_gantry_may_be_unknown(tmp_path, gantry):
    found = read_recording(folder_with(tmp_path, HEADER, META | {"gantry": gantry}))
    assert found.nominal("gantry", "supply_V") is None
    assert found.nominal("gantry", "pulley_radius_m") == (gantry or {}).get("pulley_radius_m")


def test_all_clocks_can_be_counted_from_the_earliest_stamp(tmp_path):
    frames, mallet = rows("1700000000.25,1,0.5,,", "1700000000.5,1,0.5,,"), "t,mallet_x,mallet_y\n1700000000,0.2,0.5\n"
    found = read_recording(folder_with(tmp_path, frames, mallet=mallet, drive="t,pwm_left,pwm_right\n")).from_zero()
    assert found.frames is not None and found.mallet is not None and found.drive is not None
    assert found.frames.t.tolist() == [0.25, 0.5] and found.mallet.t.tolist() == [0.0] and found.drive.rows == 0
    assert found.frames["puck_x"].tolist() == [1.0, 1.0]


def test_refuses_what_is_no_recording(tmp_path):
    with pytest.raises(RecordingError, match="is not a folder"):
        read_recording(tmp_path / "nowhere")
    with pytest.raises(RecordingError, match=r"meta\.json.*missing"):
        read_recording(tmp_path)
    with pytest.raises(RecordingError, match="contains no stream"):
        read_recording(folder_with(tmp_path / "b"))
    (tmp_path / "b" / "frames.csv").mkdir()
    with pytest.raises(RecordingError, match="not a plain file"):
        read_recording(tmp_path / "b")


def test_a_few_far_points_are_blunders_not_a_wrong_table(tmp_path):
    lines = [f"{k / 100},{1 + k / 100},0.5,," for k in range(20)]
    lines[7] = "0.07,9,0.5,,"
    found = read_recording(folder_with(tmp_path, rows(*lines)))
    assert np.flatnonzero(found.outside()).tolist() == [7]
    assert len(found.notes) == 1 and "1 positions" in found.notes[0]


cells = st.one_of(st.just(np.nan), st.floats(0, 1))


@settings(max_examples=25, deadline=None)
@given(st.lists(st.tuples(st.floats(1e-3, 1e-1), cells, cells), max_size=20))
def test_what_is_written_is_read_back_to_the_bit(tmp_path_factory, steps):
    t = np.cumsum([step[0] for step in steps]) if steps else np.zeros(0)
    x, y = np.array([s[1] for s in steps]), np.array([s[2] for s in steps])
    blank = np.full(len(t), np.nan)
    frames = Stream({"t": t, "puck_x": x, "puck_y": y, "opponent_x": blank, "opponent_y": blank})
    path = tmp_path_factory.mktemp("round") / "trip"
    write_recording(path, Recording("trip", META, frames))
    back = read_recording(path)
    assert back.frames is not None and back.meta["puck"] == META["puck"]
    for name, column in frames.items():
        np.testing.assert_array_equal(back.frames[name], column)


def test_writes_nothing_rather_than_a_part(tmp_path):
    t = np.array([0.0, 0.01])
    bad = Stream({"t": t[::-1], "mallet_x": t, "mallet_y": t})
    with pytest.raises(RecordingError, match=r"new.mallet\.csv:3: could not be read back"):
        write_recording(tmp_path / "new", Recording("new", META, mallet=bad))
    with pytest.raises(RecordingError, match="cannot be written"):
        write_recording(tmp_path / "new", Recording("new", {**META, "x": object()}, mallet=bad))
    assert list(tmp_path.iterdir()) == []
    (tmp_path / "new").mkdir()
    with pytest.raises(RecordingError, match="exists already"):
        write_recording(tmp_path / "new", Recording("new", META))


@pytest.mark.slow
def test_real_and_practice_recordings_are_read_whole():
    if not SHARED.is_dir():
        pytest.skip(f"the shared recordings are not beside this checkout ({SHARED})")
    folders = [path.parent for path in SHARED.glob("*/*/meta.json")]
    assert len(folders) > 5
    for folder in folders:
        for name, stream in read_recording(folder).streams().items():
            lines = (folder / f"{name}.csv").read_text().splitlines()
            assert stream.rows == sum(bool(line.strip()) for line in lines) - 1, (folder, name)
