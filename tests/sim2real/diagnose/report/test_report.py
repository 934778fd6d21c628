"""The report: well-formed, safe, self-contained, and consistent with diagnosis.json."""

import re
from dataclasses import replace
from html.parser import HTMLParser

import pytest

from sim2real.diagnose.output.files import as_dict, write
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.report.findings import how_much
from sim2real.diagnose.report.page import page
from sim2real.diagnose.result.context import ReportContext
from sim2real.diagnose.result.result import (
    Alternative,
    Estimate,
    Finding,
    Proof,
    RegimeResult,
    SensorSummary,
)
from tests.sim2real.diagnose.report.samples import CURVE, mismatch_sample

VOID = {"meta", "br", "img", "link", "input", "hr"}
SIGHT = SensorSummary("monday <script>alert(1)</script>", 61.5, 7380, 0.00061, 0.0002, 0.0125, 0.00018, 0.012, 0.004,
              0.001, 12, 80, 66, 3,
              ("frames.csv: 2 positions <b>far</b> outside",))  # fmt: skip
TILT = Finding(
    "glide", "table_tilt", (), ("heading",), "a = (tilt_x, tilt_y)",
    {"tilt_x": Estimate(0.020018, 0.019931, 0.020105, "m/s^2")}, 1e-30, 5.2917, 0.99243,
    alternatives=(Alternative("push by time", 398.7, "explains 99 % of what the model explains"),), curve=CURVE,
)  # fmt: skip


class Reader(HTMLParser):
    """Checks that tags close in order, and collects text and tags."""

    def __init__(self, html: str) -> None:
        super().__init__()
        self.open: list[str] = []
        self.tags: list[tuple[str, dict[str, str | None]]] = []
        self.words: list[str] = []
        self.feed(html)
        self.close()
        assert not self.open

    def handle_starttag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))
        if tag not in VOID:
            self.open.append(tag)

    def handle_startendtag(self, tag, attrs):
        self.tags.append((tag, dict(attrs)))

    def handle_endtag(self, tag):
        assert self.open.pop() == tag

    def handle_data(self, data):
        self.words.append(data)

    @property
    def text(self) -> str:
        return " ".join(" ".join(self.words).split())

    @property
    def sections(self) -> list[str | None]:
        return [attrs.get("id") for tag, attrs in self.tags if tag == "section"]


def _glide(findings=(), defaults=False, undetermined="", further="", mismatch=None) -> RegimeResult:
    baseline = {} if undetermined else {"friction": Estimate(0.12511, 0.12498, 0.12524, "m/s^2")}
    proof = None if undetermined else Proof(0.0032071, 0.00060132, 0.00060594, 10)
    return RegimeResult("glide", findings, baseline, defaults, proof, undetermined, further, mismatch, proof=proof)


DIAGNOSES = {
    "agrees": Diagnosis((_glide(defaults=True, mismatch=mismatch_sample()),), sensor_summaries=(SIGHT,)),
    "parameters_only": Diagnosis((_glide(),), sensor_summaries=(SIGHT,)),
    "missing_physics": Diagnosis((_glide((TILT,), mismatch=mismatch_sample()),), sensor_summaries=(SIGHT, SIGHT)),
    "undetermined": Diagnosis(
        (_glide(undetermined="too little data", further="record a minute"),), sensor_summaries=(SIGHT,)
    ),
}


@pytest.mark.parametrize("verdict", DIAGNOSES)
def test_every_verdict_has_its_page(verdict):
    diagnosis = DIAGNOSES[verdict]
    assert diagnosis.verdict == verdict
    read = Reader(page(diagnosis))
    assert [s for s in read.sections if s and "finding" not in s] == ["overview", "next", "regime-glide", "sensor"]
    assert ("finding-1" in read.sections) == (verdict == "missing_physics")
    assert [tag for tag, _ in read.tags].count("h1") == 1
    assert verdict.replace("_", " ") in read.text


def test_a_diagnosis_without_results_gives_the_reason():
    nothing = Diagnosis((), "a and b are not of one table", "diagnose each recording separately", ("b: <old>",))
    read = Reader(page(nothing, ReportContext(("a", "b"))))
    assert "These recordings cannot determine whether physics is missing: a and b are not of one table." in read.text
    assert nothing.remedy in read.text and "b: <old>" in read.text and "Recordings: a, b" in read.text
    assert read.sections == ["overview", "next"]


@pytest.mark.parametrize("verdict", DIAGNOSES)
def test_nothing_is_fetched(verdict):
    html = page(DIAGNOSES[verdict])
    for tag, attrs in Reader(html).tags:
        assert tag not in ("script", "link", "iframe", "object", "embed", "base")
        for name in ("src", "href", "xlink:href", "action", "data"):
            value = attrs.get(name)
            assert value is None or value.startswith(("#", "data:"))
    assert not re.search(r"https?:|url\(|@import|javascript:|<!DOCTYPE svg|<\?xml", html)
    assert len(html) < 3_000_000


def test_the_same_diagnosis_gives_the_same_bytes():
    html = page(DIAGNOSES["missing_physics"])
    assert html == page(DIAGNOSES["missing_physics"])
    identifiers = [attrs["id"] for _, attrs in Reader(html).tags if "id" in attrs]
    assert len(identifiers) == len(set(identifiers))


def test_undetermined_parameters_are_marked():
    numbers = {"mu": Estimate(0.15, 0.14, 0.16, "1"), "decay": Estimate(0.0, 0.0, 1.624, "1/s")}
    finding = replace(TILT, regime="wall", mechanism="wall_friction_spin", parameters=numbers)
    read = Reader(page(Diagnosis((_glide((finding,)),), sensor_summaries=(SIGHT,))))
    assert "mu 0.15 0.14 … 0.16" in read.text and "decay not determined 0 … 1.624 1/s" in read.text


def test_names_and_notes_are_text_and_no_markup():
    hostile = '"><script>alert(1)</script><img src=x onerror=y>'
    finding = replace(TILT, formula=hostile, mechanism="unlisted", where={hostile: [hostile]}, depends_on=(hostile,))
    alternative = replace(finding, alternatives=(Alternative(hostile, 1.0, hostile),), also_possible=(hostile,))
    regime_result = replace(_glide((alternative,), further=hostile), undetermined=hostile)
    html = page(
        Diagnosis((regime_result,), hostile, sensor_summaries=(replace(SIGHT, recording=hostile, notes=(hostile,)),))
    )
    read = Reader(html)
    assert not {"script", "img"} & {tag for tag, _ in read.tags}
    assert hostile in read.text


def test_the_numbers_are_those_of_the_diagnosis():
    diagnosis = DIAGNOSES["missing_physics"]
    words, text = as_dict(diagnosis), Reader(page(diagnosis)).text
    shown = [*words["baseline"]["parameters"].values(), *words["findings"][0]["parameters"].values()]
    for one in shown:
        for key in ("value", "low", "high"):
            assert f"{one[key]:.4g}" in text
    for key in ("before_m", "after_m", "floor_m"):
        assert f"{1e3 * words['heldout'][key]:.4g} mm" in text
    assert f"from {words['findings'][0]['heldout']['before']:.4g} without this law to" in text
    assert "push by time" in text and "explains 99 %" in text


def test_figures_and_tables_are_accessible():
    read = Reader(page(DIAGNOSES["missing_physics"]))
    pictures = [attrs for tag, attrs in read.tags if tag == "svg"]
    assert len(pictures) >= 5
    assert all(attrs.get("role") == "img" and attrs.get("aria-label") for attrs in pictures)
    tags = [tag for tag, _ in read.tags]
    assert tags.count("table") == tags.count("caption") == tags.count("thead")
    assert all(attrs.get("scope") in ("row", "col") for tag, attrs in read.tags if tag == "th")


def test_the_sensor_is_described_by_recording():
    blind = replace(SIGHT, recording="blind", frames=0)
    read = Reader(page(replace(DIAGNOSES["agrees"], sensor_summaries=(SIGHT, blind))))
    assert "noise of a position [mm] 0.61 –" in read.text
    assert "frames without the puck 1.20 % –" in read.text and "camera no camera" in read.text
    assert "launches 12 –" in read.text


def test_what_was_not_recorded_is_not_tested():
    """No statement of agreement on a regime without data."""
    blind = replace(SIGHT, frames=0)
    gantry = RegimeResult("gantry", (), {}, True, Proof(0.004, 0.002, 0.001, 1), proof=Proof(0.004, 0.002, 0.001, 1))
    read = Reader(page(Diagnosis((RegimeResult("sensing", (), {}, True, None), gantry), sensor_summaries=(blind,))))
    assert "Not tested: no camera frame shows a puck (frames.csv)." in read.text
    assert "to the noise" not in read.text and "However, residuals are 2 times the noise." in read.text
    assert "Rms residual on 1 segment of some seconds" in read.text and "No camera: only the gantry" in read.text
    assert [row in read.text for row in ("wall not tested", "gantry not tested")] == [True, False]
    seen = Reader(
        page(Diagnosis((RegimeResult("sensing", (), {}, True, None), _glide(defaults=True)), sensor_summaries=(SIGHT,)))
    )
    assert "Not tested: the camera's delay and clock, since the robot's mallet was not recorded" in seen.text
    assert "gantry not tested: the robot's mallet was not recorded (mallet.csv)" in seen.text


def test_refitted_parameters_are_shown_beside_the_previous_ones():
    for baseline, head in (({}, "default"), ({"friction": 0.31}, "your baseline")):
        read = Reader(page(DIAGNOSES["parameters_only"], ReportContext(("a",), baseline)))
        assert f"parameter {head} fitted" in read.text
        shown = baseline.get("friction", 0.125)
        assert f"friction {shown} 0.1251 0.125 … 0.1252 m/s²" in read.text
    read = Reader(page(DIAGNOSES["agrees"], ReportContext(("a",), {"friction": 0.31})))
    assert "The simulator with your baseline explains" in read.text and "default parameters" not in read.text


def test_sensor_faults_are_corrected_and_not_refitted():
    late = replace(TILT, regime="sensing", mechanism="camera_delay", formula="t - delay_s", curve=None, alternatives=())
    faults = RegimeResult(
        "sensing", (late,), {}, False, Proof(0.004, 0.002, 0.001, 3), proof=Proof(0.004, 0.002, 0.001, 3)
    )
    read = Reader(page(Diagnosis((faults,), sensor_summaries=(SIGHT,))))
    section = read.text.split("Regime: sensing")[1]
    assert "Sensor faults: camera_delay (the camera's frames are stamped late)." in section
    picture = next(one for tag, one in read.tags if tag == "svg" and "sensing" in (one.get("aria-label") or ""))
    assert "as recorded 4 mm, corrected 2 mm" in (picture["aria-label"] or "")
    assert "The camera's frames are stamped late: each shows the table as it was" in read.text
    assert "The findings do not explain all: the sensing residuals are 2 times" in read.text


def test_coefficients_are_folded_and_their_law_is_described():
    numbers = {f"c{k}": Estimate(0.1 * k, 0.0, 1.0, "1") for k in range(14)}
    law = replace(
        TILT, regime="gantry", mechanism="unlisted", formula="pull by history", parameters=numbers, curve=None
    )
    read = Reader(page(Diagnosis((replace(_glide((law,)), regime="gantry"),), sensor_summaries=(SIGHT,))))
    assert "whose size is a smooth function of the volts and the speed of the last second" in read.text
    assert "14 coefficients of the law's basis functions" in read.text


def test_the_least_p_value_is_printed_as_a_bound():
    read = Reader(page(Diagnosis((_glide((replace(TILT, p_value=1e-300),)),), sensor_summaries=(SIGHT,))))
    assert "p < 1e-300" in read.text and "= 1.0e-300" not in read.text


@pytest.mark.parametrize(
    "loss, expected", [(5.0, "equivalent"), (20.0, "slightly"), (400.0, "strongly"), (2.6e4, "very strongly")]
)
def test_how_much_worse_an_alternative_is(loss, expected):
    assert how_much(loss) == expected


def test_ambiguity_is_reported():
    finding = replace(TILT, also_possible=("table_warp",))
    read = Reader(page(Diagnosis((_glide((finding,), further="record slow glides"),), sensor_summaries=(SIGHT,))))
    assert "Also possible: table_warp" in read.text and "record slow glides" in read.text


def test_the_page_is_written_whole_beside_the_rest(tmp_path):
    written = write(DIAGNOSES["missing_physics"], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(path.name for path in written)
    assert (tmp_path / "report.html").read_text(encoding="utf-8") == page(DIAGNOSES["missing_physics"])
