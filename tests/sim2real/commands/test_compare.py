"""`compare`: correct numbers on simulated paths, and a one-line message when it cannot compare."""

import json
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from puckpilot import main
from puckpilot_env.physics.contacts import bounce, contact
from puckpilot_env.physics.sliding import glide
from sim2real.commands.compare import print_summary
from sim2real.compare.glides import predict_glide
from sim2real.compare.map_error import MapError
from sim2real.compare.predict import compare_segments
from sim2real.compare.summary import summarize
from sim2real.diagnose.engine.problem import record_of
from sim2real.recording.folder import Recording, Stream, read_recording, write_recording
from sim2real.recording.table_parameters import parameters
from sim2real.segmentation.segments import segment
from sim2real.segmentation.sensor_noise import Noise
from tests.places import SHARED

META = {
    "format": "puckpilot-recording/1",
    "table": {"length_m": 2.0, "width_m": 1.0, "goal_width_m": None},
    "puck": {"radius_m": 0.03},
    "mallet": {"radius_m": 0.05},
    "camera": {"rate_hz": 150.0, "position_std_m": None},
}
SIZE = np.array([2.0, 1.0])


def glides(friction: float, drag: float, noise: float = 0.0005, count: int = 12) -> Recording:
    """Free glides under the simulator's law, without contacts."""
    rng = np.random.default_rng(0)
    t = np.arange(150) / 150
    places = []
    for speed in rng.uniform(0.5, 1.5, count):
        way = np.array([glide.distance(speed, at, friction, drag) for at in t])
        angle = rng.uniform(-0.2, 0.2)
        places.append(np.stack([0.2 + way * np.cos(angle), 0.5 + way * np.sin(angle)], axis=1))
    p = np.concatenate(places) + rng.normal(0, noise, (150 * count, 2))
    unseen = np.full(len(p), np.nan)
    clock = np.arange(len(p)) / 150
    columns = {"t": clock, "puck_x": p[:, 0], "puck_y": p[:, 1], "opponent_x": unseen, "opponent_y": unseen}
    return Recording("glides", META, Stream(columns))


def command(*words: str) -> int:
    """As a user calls it."""
    return main(["compare", *words])


@pytest.mark.parametrize(("friction", "drag"), [(0.125, 0.125), (0.0, 0.3), (0.2, 0.0), (0.0, 0.0)])
def test_the_stand_in_obeys_its_equation_in_all_limits(friction, drag):
    t, h = 0.7, 1e-5
    v = glide.speed(1.3, t, friction, drag)
    assert (glide.distance(1.3, t + h, friction, drag) - glide.distance(1.3, t - h, friction, drag)) / (
        2 * h
    ) == pytest.approx(v, rel=1e-6)
    slope = (glide.speed(1.3, t + h, friction, drag) - glide.speed(1.3, t - h, friction, drag)) / (2 * h)
    assert slope == pytest.approx(-friction - drag * v * v, abs=1e-6)
    assert glide.distance(0.0, 1.0, friction, drag) == 0.0


def test_the_stand_in_reflects():
    assert bounce.reflect(1.0, -2.0, 0.0, 1.0, 0.5) == (0.5, 1.0)
    assert contact.reflect(-1.0, 0.5, 2.0, 0.0, 1.0, 0.0, 0.5) == (3.5, 0.5)


def test_glides_of_the_same_law_differ_by_noise_alone():
    recording = glides(0.125, 0.125)
    found = compare_segments(recording, segment(recording), parameters(recording))
    assert len(found.glides) == 12
    ratio = [np.sqrt(np.mean((g.error[g.fitted :] / g.std[g.fitted :]) ** 2)) for g in found.glides]
    assert np.mean(ratio) == pytest.approx(1.0, abs=0.15)


def test_glides_of_another_law_show_its_distance():
    recording = glides(0.4, 0.125, noise=0.0002)
    segments = segment(recording)
    for one in segments.glides:
        off = predict_glide(one, Noise(0.0002, 0.0), MapError(SIZE, 0.0), record_of({}))
        ahead = off.t[-1] - off.t[off.fitted - 1]
        # 0.275 m/s^2 more: the start's fit, centred in its part, splits the parabola as least squares does
        part = off.t[off.fitted - 1]
        expected = -0.5 * 0.275 * (ahead**2 + ahead * part + part**2 / 6)
        assert off.error[-1, 0] == pytest.approx(expected, rel=0.12)
        assert abs(off.error[-1, 1]) < 0.003


def test_missing_rows_are_told(tmp_path, capsys):
    complete = glides(0.125, 0.125)
    assert complete.frames is not None
    kept = np.r_[:700, 900:1800]  # 200 frames, 1.3 s, are missing
    columns = {name: complete.frames[name][kept] for name in ("t", "puck_x", "puck_y", "opponent_x", "opponent_y")}
    write_recording(tmp_path / "gap", Recording("gap", META, Stream(columns)))
    assert command(str(tmp_path / "gap"), "--out", str(tmp_path / "o")) == 0
    printed = [line for line in capsys.readouterr().out.splitlines() if line.startswith("note: ")]
    assert "note: gap: frames.csv has 1 pause of more than 0.5 s and is cut there" in printed


def test_prints_one_json_object_and_draws(tmp_path, capsys):
    write_recording(tmp_path / "glides", glides(0.4, 0.125))
    assert command(str(tmp_path / "glides"), "--json", "--out", str(tmp_path / "o")) == 0
    summary = json.loads(capsys.readouterr().out)
    assert summary["glide"]["pieces"] == 12 and summary["wall"] == {"pieces": 0}
    assert summary["part_most"].startswith("glides: at the end of a glide") and "less far" in summary["part_most"]
    assert Path(summary["picture"]).read_bytes().startswith(b"\x89PNG")


def test_says_in_one_line_what_it_cannot_read_or_write(tmp_path, capsys):
    assert command(str(tmp_path / "none"), "--out", str(tmp_path / "o")) == 2
    assert "is not a folder" in capsys.readouterr().err
    assert not (tmp_path / "o").exists()
    write_recording(tmp_path / "glides", glides(0.1, 0.1, count=2))
    (tmp_path / "file").write_text("")
    assert command(str(tmp_path / "glides"), "--out", str(tmp_path / "file")) == 2
    error = capsys.readouterr().err
    assert "cannot write the picture" in error and error.count("\n") == 1


def test_a_gantry_alone_is_nothing_to_compare_and_no_crash(tmp_path, capsys):
    t = np.arange(5) / 100
    write_recording(tmp_path / "g", Recording("g", META, mallet=Stream({"t": t, "mallet_x": t, "mallet_y": t})))
    assert command(str(tmp_path / "g"), "--out", str(tmp_path)) == 0
    printed = capsys.readouterr().out
    assert "largest difference: unknown" in printed and "run puckpilot diagnose" in printed


def test_numbers_that_tell_little_are_said_to(tmp_path):
    segments = segment(recording := glides(0.1, 0.1, count=2))
    values = parameters(recording)
    found = compare_segments(recording, segments, values)
    few = summarize(recording, segments, found, values)["notes"][-1]
    assert few.startswith("medians of fewer than 10 segments are unreliable (2 of glide)")
    lost = {**found.unusable, "other": Counter({"unexplained events": 7})}
    notes = summarize(recording, segments, replace(found, unusable=lost), values)["notes"]
    assert notes[-1].startswith("7 of 7 changes of motion are unexplained")


def test_the_simulator_s_own_ratios_stand_beside_those_seen(capsys):
    kept = {"median": 0.5, "low": 0.4, "high": 0.6}
    part = dict.fromkeys(("error_mps", "restitution_normal", "restitution_tangential", "times_noise"), kept)
    recording = glides(0.1, 0.1, count=2)
    segments, values = (
        segment(recording),
        parameters(recording) | {"wall_restitution": 0.77, "mallet_restitution": 0.66},
    )
    summary = summarize(recording, segments, compare_segments(recording, segments, values), values)
    print_summary({**summary, "wall": {"pieces": 20, **part}, "mallet": {"pieces": 20, **part}, "picture": ""})
    rows = [line.replace("│", " ").split() for line in capsys.readouterr().out.splitlines()]
    shown = [row[-1] for row in rows if row[:1] != ["where"] and "ratio" in row]
    assert shown == ["0.77", "0.77", "0.66", "1.00"]
    before, after, normal = np.array([-1.0, 0.5]), np.array([0.66, 0.5]), (1.0, 0.0)
    assert contact.reflect(*before, 0.0, 0.0, *normal, 0.66) == pytest.approx(tuple(after))  # what that says


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "practice/null",
        pytest.param("practice/tilt", marks=pytest.mark.long),
        pytest.param("practice/sag", marks=pytest.mark.long),
        "ubc/play_a",
        "ubc/noise_a",
    ],
)
def test_shared_recordings_are_compared(tmp_path, capsys, name):
    if not SHARED.is_dir():
        pytest.skip(f"the shared recordings are not beside this checkout ({SHARED})")
    assert command(str(SHARED / name), "--json", "--out", str(tmp_path)) == 0
    summary = json.loads(capsys.readouterr().out)
    if name not in ("practice/null", "practice/tilt"):
        return
    assert (
        summary["part_most"].startswith("wall contacts") and "is 0.80 normal" in summary["part_most"]
    )  # here it is 0.7
    recording = read_recording(SHARED / name)
    segments, values = segment(recording), parameters(recording) | {"wall_restitution": 0.8}
    found = compare_segments(recording, segments, values)
    assert np.median([np.max(np.abs(h.error) / h.std) for h in found.walls]) < 2.0
    if name == "practice/null":
        assert summary["glide"]["times_noise"]["median"] == pytest.approx(1.0, abs=0.1)
    else:
        assert summarize(recording, segments, found, values)["part_most"].startswith("glides")
