"""Labelled cases: what is drawn, recordings do not reveal the truth, and a seed reproduces the cases."""

from __future__ import annotations

import json
from collections import Counter
from dataclasses import fields, replace
from itertools import combinations
from pathlib import Path

import numpy as np
import pytest

from sim2real.study.independent_table import Law, make_cases
from sim2real.study.independent_table.cases import BLOCK, DISTURBANCES, KINDS, MAP_ERROR, SPIN, draw_case
from sim2real.study.independent_table.mechanisms import INCOMPATIBLE, MECHANISMS
from sim2real.study.independent_table.physics.puck import acceleration
from sim2real.study.independent_table.physics.unlisted import LAWS
from sim2real.study.independent_table.recorder.film import noise
from sim2real.study.independent_table.recorder.record import make_recording
from sim2real.study.independent_table.recorder.scene import Hand

BASELINE = [field.name for field in fields(Law)][:17]
SENSED = ("launches", "posts", "rally", "match")


def test_every_block_holds_every_kind_and_every_mechanism_comes_once_a_round():
    cases = [draw_case(5, number) for number in range(80)]
    assert BLOCK == 20
    for start in range(0, 80, BLOCK):
        assert Counter(case.truth["kind"] for case in cases[start : start + BLOCK]) == KINDS
    ones = [case.truth["mechanisms"][0] for case in cases if case.truth["kind"] == "one"]
    assert Counter(ones[: len(MECHANISMS)]) == dict.fromkeys(MECHANISMS, 1)
    unlisted = [case.truth["law"] for case in cases if case.truth["kind"] == "unlisted"]
    assert set(unlisted) <= set(LAWS)
    assert len(set(unlisted)) == len(unlisted)
    assert draw_case(5, 7) == cases[7]
    assert draw_case(6, 7) != cases[7]


def test_what_is_missing_is_in_the_law_and_nothing_else_is():
    for number in range(100):
        case = draw_case(1, number)
        off = Law()
        changed = {f.name for f in fields(Law) if getattr(case.law, f.name) != getattr(off, f.name)}
        sizes = {"length", "width", "goal_width", "puck_radius", "mallet_radius"}
        kind, names = case.truth["kind"], case.truth["mechanisms"]
        assert case.truth["verdict"] == {"nothing": "agrees", "parameters": "parameters_only"}.get(
            kind, "missing_physics"
        )
        if kind == "nothing":
            assert changed <= sizes
        elif kind == "parameters":
            assert changed <= set(BASELINE) and "friction" in changed
        elif "held_frames" in names:
            assert case.camera.held > 0.05
        elif "stamp_jitter" in names:
            assert case.camera.arrival > 1e-4
        else:
            assert changed - set(BASELINE)
        assert case.camera.held <= 0.02 or "held_frames" in names
        assert len(names) == {"nothing": 0, "parameters": 0, "two": 2}.get(kind, 1)
        assert not any(len(names) == 2 and set(names) <= group for group in INCOMPATIBLE)
        regimes = case.truth["regimes"]
        assert ("gantry" in regimes) <= (case.scenario in ("gantry", "drive"))
        assert bool(set(regimes) & {"glide", "wall", "corner", "mallet"}) <= (case.scenario in SENSED)


@pytest.mark.slow
@pytest.mark.parametrize("name", [*MECHANISMS, *LAWS])
def test_each_can_be_asked_for_and_changes_the_recording(name: str, tmp_path: Path):
    case = draw_case(2, 0, name=name)
    assert case.truth["kind"] == ("one" if name in MECHANISMS else "unlisted")
    seconds = 40.0 if name in ("push", "soft_stretch") else 6.0  # these are met later, or seldom
    truth = make_recording(tmp_path / "a", case.law, case.scenario, 3, seconds, case.camera, hand=case.hand, dt=1e-4)
    if name in ("held_frames", "stamp_jitter"):  # faults of the camera, which stays the same below
        assert (case.camera.held > 0.05) == (name == "held_frames")
        assert (case.camera.arrival > 2e-4) == (name == "stamp_jitter")
        if name == "stamp_jitter":
            exact = replace(case.camera, arrival=0.0)
            make_recording(tmp_path / "c", case.law, case.scenario, 3, 6.0, exact, hand=case.hand, dt=1e-4)
            seen, known = (np.genfromtxt(tmp_path / part / "frames.csv", delimiter=",", names=True) for part in "ac")
            assert np.array_equal(seen["puck_x"], known["puck_x"], equal_nan=True)
            assert np.std(seen["t"] - known["t"]) == pytest.approx(case.camera.arrival, rel=0.1)
        return
    known = {key: getattr(case.law, key) for key in BASELINE}
    plain = Law(**known)
    still = make_recording(tmp_path / "b", plain, case.scenario, 3, seconds, case.camera, hand=case.hand, dt=1e-4)
    if name in ("camera_delay", "clock_drift", "scale_error"):
        files = ("frames.csv", "mallet.csv") if case.scenario != "launches" else ("frames.csv",)
        assert any((tmp_path / "a" / f).read_bytes() != (tmp_path / "b" / f).read_bytes() for f in files)
        return
    path = truth.mallets[0] if case.truth["regimes"] == ["gantry"] else truth.puck
    other = still.mallets[0] if case.truth["regimes"] == ["gantry"] else still.puck
    assert np.nanmax(abs(path - other)) > 2e-4


@pytest.mark.parametrize(
    "names", list(combinations(["friction_anisotropy", "air_drift", "friction_patch", "linear_drag"], 2))
)
def test_brakes_that_come_as_two_are_both_felt(names: tuple[str, str]):
    """In a pair of friction effects, each adds at least half of its own effect to that of the other."""
    assert not any(set(names) <= group for group in INCOMPATIBLE)
    for seed in range(4):  # both forms of the uneven friction
        changes = [MECHANISMS[name].draw(np.random.default_rng(seed), 1.0, Law(), "launches").law for name in names]
        x, y = ({**changes[0], **changes[1]}.get(f"patch_{axis}", 0.5) for axis in "xy")

        def brake(*some: dict[str, float], x: float = x, y: float = y) -> float:
            law = replace(Law(), **{name: value for change in some for name, value in change.items()}).numbers()
            return acceleration(law, 10.0, x, y, 0.4, 0.0, 0.0, 1.0)[0]

        for one, other in (changes, changes[::-1]):
            assert abs(brake(one, other) - brake(other)) > 0.5 * abs(brake(one) - brake()) > 0.002


def test_sizes_of_an_effect_lie_between_half_and_double_the_typical():
    tilts = [draw_case(3, n, name="table_tilt").truth["values"]["table_tilt"] for n in range(60)]
    sizes = np.array([np.hypot(tilt["tilt_x"], tilt["tilt_y"]) for tilt in tilts]) / 0.023
    assert 0.5 <= sizes.min() < 0.65 and 1.6 < sizes.max() <= 2.0
    assert np.median(sizes) == pytest.approx(1.0, abs=0.25)


def test_a_folder_holds_nothing_that_gives_the_truth_away(tmp_path: Path):
    make_cases.main(["--cases", "4", "--seed", "9", "--out", str(tmp_path), "--seconds", "4", "--workers", "1"])
    labels = [f"case_{k:04d}" for k in range(1, 5)]
    for part in ("recordings", "heldout"):
        assert sorted(path.name for path in (tmp_path / part).iterdir()) == labels
    assert sorted(path.name for path in (tmp_path / "key").iterdir()) == [f"{label}.json" for label in labels]
    words = [*MECHANISMS, *LAWS, "unlisted", "mechanism", "seed"]
    for file in (tmp_path / "recordings").rglob("*"):
        if file.is_file():
            assert file.name in ("meta.json", "frames.csv", "mallet.csv", "commands.csv", "drive.csv")
            assert not [word for word in words if word in file.read_text()]
    meta = json.loads((tmp_path / "recordings" / labels[0] / "meta.json").read_text())
    assert set(meta) <= {"format", "table", "puck", "mallet", "camera", "gantry", "note"}
    a, b = ((tmp_path / part / labels[0] / "meta.json").read_text() for part in ("recordings", "heldout"))
    assert a == b


def test_the_same_seed_makes_the_same_files_and_what_is_there_stays(tmp_path: Path):
    words = ["--cases", "2", "--seed", "9", "--seconds", "2", "--workers", "1", "--out"]
    for name in ("a", "b"):
        make_cases.main([*words, str(tmp_path / name)])
    files = sorted(path.relative_to(tmp_path / "a") for path in (tmp_path / "a").rglob("*") if path.is_file())
    assert all((tmp_path / "a" / f).read_bytes() == (tmp_path / "b" / f).read_bytes() for f in files)
    mark = tmp_path / "a" / "recordings" / "case_0001" / "frames.csv"
    mark.write_text("kept")
    make_cases.main([*words, str(tmp_path / "a")])
    assert mark.read_text() == "kept"


def test_an_unknown_kind_or_mechanism_is_refused(capsys: pytest.CaptureFixture[str], tmp_path: Path):
    for option in (["--only", "some"], ["--mechanism", "gremlins"]):
        with pytest.raises(SystemExit):
            make_cases.main(["--cases", "1", "--out", str(tmp_path), *option])
        assert "expected one of" in capsys.readouterr().err


def test_a_hand_may_spin_the_puck_and_aim_at_posts(tmp_path: Path):
    aimed = make_recording(tmp_path, Law(), "posts", 3, 40.0, dt=1e-4)
    loose = make_recording(tmp_path, Law(), "launches", 3, 40.0, dt=1e-4)
    posts = [sum(c.kind == "post" for c in scene.contacts) for scene in (aimed, loose)]
    assert posts[0] >= 5 > posts[1]
    law = Law(spin_side_force=0.01)
    turned = make_recording(tmp_path, law, "launches", 3, 3.0, hand=Hand(spin=20.0), dt=1e-4)
    straight = make_recording(tmp_path, law, "launches", 3, 3.0, dt=1e-4)
    assert np.nanmax(abs(turned.puck - straight.puck)) > 0.01


def test_disturbed_cases_miss_nothing_and_take_turns():
    cases = [draw_case(4, number, "disturbed") for number in range(6)]
    assert [case.truth["disturbance"] for case in cases] == [*DISTURBANCES, *DISTURBANCES]
    assert all((case.truth["verdict"], case.truth["mechanisms"]) == ("agrees", []) for case in cases)
    assert [case.camera.place_error for case in cases] == [MAP_ERROR, 0.0, 0.0] * 2
    assert [case.hand.spin for case in cases] == [0.0, 0.0, SPIN] * 2
    assert not {case.scenario for case in cases} & {"gantry", "drive"}
    for case in cases[1::3]:
        step = np.arange(40_000) / case.camera.rate
        one = noise(np.random.default_rng(1), step, case.camera.correlation_time, case.camera.correlated)
        assert np.var(one) == pytest.approx(1.0, abs=0.03)
        assert np.corrcoef(one[1:, 0], one[:-1, 0])[0, 1] == pytest.approx(0.6, abs=0.02)
        assert np.corrcoef(one[2:, 0], one[:-2, 0])[0, 1] == pytest.approx(0.36, abs=0.03)
