"""The HTML page of a diagnosis, from the templates beside this file."""

from __future__ import annotations

from pathlib import Path

from jinja2 import Environment, FileSystemLoader, StrictUndefined
from markupsafe import Markup

from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.report.charts import bars_picture
from sim2real.diagnose.report.findings import finding_view
from sim2real.diagnose.report.plain_words import NOTHING, number, proof_sizes, residual_words
from sim2real.diagnose.report.regimes import regime_view
from sim2real.diagnose.report.sensor import sensor_view
from sim2real.diagnose.report.summary import sentence
from sim2real.diagnose.result.context import PLAIN, ReportContext
from sim2real.diagnose.result.result import RegimeResult
from sim2real.diagnose.result.untested import untested
from sim2real.diagnose.tuned import RESIDUALS

TEMPLATES = Path(__file__).parent / "templates"
NO_SIZES = (NOTHING, NOTHING, NOTHING)


def page(diagnosis: Diagnosis, context: ReportContext = PLAIN) -> str:
    """Return the diagnosis as one self-contained HTML page without scripts."""
    environment = Environment(
        loader=FileSystemLoader(TEMPLATES), autoescape=True, undefined=StrictUndefined, trim_blocks=True,
        lstrip_blocks=True, keep_trailing_newline=True,
    )  # fmt: skip
    missing, bars = untested(diagnosis), ""
    if diagnosis.proof is not None:
        bars = bars_picture("Residuals on the holdout", proof_sizes(diagnosis.proof, bool(diagnosis.findings)))
    return environment.get_template("page.html.j2").render(
        diagnosis=diagnosis,
        verdict=sentence(diagnosis, context),
        recordings=context.recordings or [one.recording for one in diagnosis.sensor_summaries],
        overview=_overview(diagnosis, missing),
        bars=bars,
        findings=[finding_view(one, k) for k, one in enumerate(diagnosis.findings, 1)],
        unexplained=_unexplained(diagnosis),
        regimes=[regime_view(each, context, missing) for each in diagnosis.regime_results],
        sensor=sensor_view(diagnosis),
    )


def _overview(diagnosis: Diagnosis, missing: dict[str, str]) -> list[list[str]]:
    """Return a row for each regime: name, missing laws, residuals in units of the noise, size of the holdout."""
    tested = {each.regime for each in diagnosis.regime_results}
    rows = [_row(each, missing) for each in diagnosis.regime_results]
    return rows + [[name, f"not tested: {why}", *NO_SIZES] for name, why in missing.items() if name not in tested]


def _row(each: RegimeResult, missing: dict[str, str]) -> list[str]:
    link = Markup('<a href="#regime-{0}">{0}</a>').format(each.regime)
    if each.regime in missing:
        return [link, f"not tested: {missing[each.regime]}", *NO_SIZES]
    names = ", ".join(one.mechanism for one in each.findings)
    return [link, names or (f"undetermined: {each.undetermined}" if each.undetermined else "nothing"), *_sizes(each)]


def _sizes(each: RegimeResult) -> tuple[str, ...]:
    if each.proof is None or not each.proof.floor_m or not each.proof.pieces:
        return NO_SIZES
    before, after = (number(size / each.proof.floor_m) for size in (each.proof.before_m, each.proof.after_m))
    return before, after if each.findings else NOTHING, str(each.proof.pieces)


def _unexplained(diagnosis: Diagnosis) -> str:
    """Return the regimes with findings whose residuals exceed the noise, in a sentence; "" if there are none."""
    found = {each.regime: each.times_noise for each in diagnosis.regime_results if each.findings}
    more = [
        f"the {name} {residual_words(times)}" for name, times in found.items() if times and times > RESIDUALS.as_noise
    ]
    return f"The findings do not explain all: {'; '.join(more)}." if more else ""
