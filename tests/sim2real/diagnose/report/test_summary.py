"""The verdict in a sentence, and the summary of a diagnosis in ten lines."""

from dataclasses import replace
from pathlib import Path

import pytest

from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.report.summary import sentence, summary
from sim2real.diagnose.result.context import ReportContext
from sim2real.diagnose.result.result import Estimate, Finding, Proof, RegimeResult

TILT = Finding("glide", "table_tilt", (), ("heading",), "a", {"x": Estimate(1.0, 0.9, 1.1, "V s^3")}, 1e-9, 5.0, 1.0)
RUB = replace(TILT, regime="wall", mechanism="wall_friction_spin", p_value=1e-8)
LAW = replace(TILT, mechanism="unlisted", depends_on=("position",), p_value=1e-7)
LATE = replace(TILT, regime="sensing", mechanism="camera_delay", p_value=1e-30)
HELD = replace(LATE, mechanism="held_frames", p_value=1e-20)


def _found(*findings: Finding) -> Diagnosis:
    return Diagnosis(
        (RegimeResult("glide", findings, {}, False, Proof(0.01, 0.001, 0.001, 1), proof=Proof(0.01, 0.001, 0.001, 1)),)
    )


@pytest.mark.parametrize(
    "findings, expected",
    [
        ((TILT,), "The simulator lacks table_tilt (the table is not level)."),
        (
            (TILT, RUB, LAW),
            "The simulator lacks 3 things: (1) table_tilt (the table is not level), (2) wall_friction_spin "
            "(walls rub), (3) an unlisted effect in the glide that depends on position.",
        ),
        (
            (LATE, HELD),
            "The camera's frames are stamped late (camera_delay); the camera repeats frames (held_frames).",
        ),
        (
            (LATE, TILT),
            "The simulator lacks table_tilt (the table is not level); the camera's frames are stamped late "
            "(camera_delay).",
        ),
        (
            (replace(TILT, also_possible=("table_warp",)),),
            "The simulator lacks table_tilt (the table is not level) or, not distinguished from it, table_warp.",
        ),
    ],
)
def test_missing_laws_are_listed_in_words(findings, expected):
    assert sentence(_found(*findings)) == expected


def test_agreement_to_the_noise_requires_residuals_of_noise():
    wall = RegimeResult("wall", (), {}, True, Proof(0.004, 0.0021, 0.001, 3), proof=Proof(0.004, 0.0021, 0.001, 3))
    glide = replace(wall, regime="glide", selection=Proof(0.001, 0.001, 0.001, 3))
    assert sentence(Diagnosis((glide,))) == (
        "The simulator with default parameters explains this recording to the noise of the sensors."
    )
    left = sentence(Diagnosis((glide, wall)), ReportContext(("a", "b"), {"friction": 0.1}))
    assert left == (
        "The simulator with your baseline explains these recordings, but the wall residuals are 2.1 times the noise."
    )


def test_ten_lines_count_and_give_units_as_print_has_them():
    lines = summary(_found(TILT), [Path("a")])
    assert any("1 [0.9, 1.1] V s³" in line for line in lines)
    assert (
        "  holdout, glide: 10.00 mm with the refitted baseline, 1.00 mm with the findings; noise alone 1.00 mm "
        "(1 launch)" in lines
    )


def test_undetermined_parameters_are_marked():
    numbers = {"mu": Estimate(0.15, 0.14, 0.16, "1"), "decay": Estimate(0.0, 0.0, 1.624, "1/s")}
    lines = summary(_found(replace(RUB, parameters=numbers)), [])
    assert lines[1].endswith("; mu 0.15 [0.14, 0.16], decay not determined (0 to 1.624 1/s)")
    fitted = {"wall_restitution": Estimate(1.0, 0.97, 1.0, "1"), "friction": Estimate(0.1, -0.1, 0.3, "m/s^2")}
    lines = summary(Diagnosis((RegimeResult("wall", (), fitted, False, None),)), [])
    assert "  wall: wall_restitution at its bound (0.97 to 1), friction not determined (-0.1 to 0.3 m/s²)" in lines


def test_every_note_is_printed_and_only_refitted_parameters_are_shortened():
    numbers = {"friction": Estimate(0.1, 0.09, 0.11, "m/s^2")}
    walls = [RegimeResult(f"wall {k}", (), numbers, True, None, f"reason {k}") for k in range(7)]
    lines = summary(Diagnosis(tuple(walls)), [])
    assert all(any(line.endswith(f"reason {k}") for line in lines) for k in range(7))
    assert (
        lines[-2] == "  refitted parameters of wall 0, wall 1, wall 2, wall 3, wall 4, wall 5, wall 6: see report.html"
    )
    few = summary(Diagnosis(tuple(walls[:2])), [])
    assert sum("friction 0.1 [0.09, 0.11]" in line for line in few) == 2


def test_findings_and_what_to_do_next_come_before_the_baseline():
    numbers = {"friction": Estimate(0.1, 0.09, 0.11, "m/s^2")}
    found = (TILT, RUB, LAW, LATE, HELD)
    regime_results = [RegimeResult(f"glide {k}", found if k == 0 else (), numbers, False, None) for k in range(6)]
    lines = summary(Diagnosis(tuple(regime_results)), [])
    assert [line.split(":")[0].strip() for line in lines[1:6]] == [
        one.mechanism for one in Diagnosis(tuple(regime_results)).findings
    ]
    assert lines[6].startswith("  next: no further recording is needed")


def test_sensor_faults_have_residuals_as_recorded():
    late = Diagnosis(
        (RegimeResult("sensing", (LATE,), {}, False, Proof(0.02, 0.004, 0.001, 6), proof=Proof(0.02, 0.004, 0.001, 6)),)
    )
    assert any("holdout, sensing: 20.00 mm as recorded, 4.00 mm with" in line for line in summary(late, []))


LOST = RegimeResult(
    "glide",
    (),
    {},
    False,
    Proof(0.01, 0.01, 0.001, 2),
    proof=Proof(0.01, 0.01, 0.001, 2),
    undetermined="who knows",
    misfit=True,
)


def test_an_unidentified_effect_is_reported():
    assert sentence(Diagnosis((LOST,))) == "An effect is missing in the glide, but this recording cannot identify it."
    note = next(line for line in summary(Diagnosis((LOST,)), []) if "note" in line)
    assert note == "  note: glide: undetermined, who knows; cross-validation residuals are 10 times the noise"


def test_undetermined_regimes_are_named_beside_the_findings():
    both = Diagnosis(
        (RegimeResult("glide", (TILT,), {}, False, None), RegimeResult("wall", (), {}, True, None, "few bounces"))
    )
    lacks = "The simulator lacks table_tilt (the table is not level)."
    assert sentence(both) == f"{lacks} (Undetermined: wall.)"
    odd = replace(LOST, regime="mallet")
    assert sentence(Diagnosis((*both.regime_results, odd))) == (
        f"{lacks} (An effect is missing in the mallet too, but cannot be identified; undetermined: wall.)"
    )


def test_open_questions_are_never_reported_as_closed():
    wide = RegimeResult("gantry", (TILT,), {}, False, Proof(0.1, 0.01, 0.001, 2), proof=Proof(0.1, 0.01, 0.001, 2))
    assert Diagnosis((wide,)).next_recording.startswith("no single recording is known")
    for left in (
        replace(wide, selection=Proof(0.1, 0.0015, 0.001, 2)),
        replace(wide, selection=None, doubt="a tilt would fit"),
    ):
        assert Diagnosis((left,)).next_recording.startswith("no single recording is known")
    assert Diagnosis((replace(wide, selection=Proof(0.1, 0.0012, 0.001, 2)),)).next_recording.startswith(
        "no further recording"
    )
    asking = RegimeResult("wall", (), {}, True, None, "few bounces", next_recording="record more bounces")
    assert Diagnosis((wide, asking)).next_recording == "record more bounces"
