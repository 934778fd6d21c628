"""A regime in the report: its conclusion, the baseline's parameters, the proof with null controls, the residuals."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from sim2real.diagnose.engine.null_controls import NULL, PERMUTED
from sim2real.diagnose.report.binned_residuals import map_arrows, unchanged
from sim2real.diagnose.report.charts import bars_picture, map_picture, residual_pictures
from sim2real.diagnose.report.intervals import estimate_cells
from sim2real.diagnose.report.plain_words import NOTHING, number, pieces, proof_sizes, residual_words, with_description
from sim2real.diagnose.result.context import ReportContext
from sim2real.diagnose.result.result import Mismatch, RegimeResult
from sim2real.diagnose.result.untested import NO_PATH
from sim2real.diagnose.tuned import RESIDUALS

FEWEST = 8  # segments that a figure needs
CONTROLS = {NULL: "simulated control", PERMUTED: "sign-flipped control"}


def regime_view(one: RegimeResult, context: ReportContext, missing: Mapping[str, str]) -> dict[str, Any]:
    """Return what regime.html.j2 shows of a regime; `missing`: missing data of regimes that were not tested."""
    bars = ""
    if one.proof is not None and one.proof.pieces:
        sizes = proof_sizes(one.proof, bool(one.findings), one.regime == "sensing")
        bars = bars_picture(f"Residuals on the holdout, {one.regime}", sizes)
    shown = one.mismatch is not None and len(one.mismatch.before) >= FEWEST
    return {
        "result": one,
        "conclusion": _conclusion(one, context, missing),
        "doubt": f"{one.doubt[:1].upper()}{one.doubt[1:]}." if one.doubt else "",
        "standard": context.standard,
        "baseline": [_baseline_row(name, each, context) for name, each in one.baseline.items()],
        "bars": bars,
        "proof": _proof(one) if bars else "",
        "null_controls": _null_controls(one),
        "residuals": _residuals(one.mismatch) if one.mismatch is not None and shown else None,
    }


def _baseline_row(name: str, estimate, context: ReportContext) -> list[str]:
    label, *fitted = estimate_cells(name, estimate)
    return [label, number(context.value(name)), *fitted]


def _proof(one: RegimeResult) -> str:
    if one.regime == "sensing":
        return (
            f"Rms position error of all sensor faults together on {pieces(one)} of the holdout; each finding lists its "
            "own residuals in units of their standard errors."
        )
    return f"Rms residual on {pieces(one)} that no fit, choice or correction used."


def _null_controls(one: RegimeResult) -> list[tuple[str, ...]]:
    """Return the rows of cross-validation residuals, of the recording and of the null controls; [] without controls."""
    controls = next((each.null_controls for each in one.findings if each.null_controls), {})
    if not controls or one.selection is None or not one.selection.floor_m:
        return []
    before, after = (number(size / one.selection.floor_m) for size in (one.selection.before_m, one.selection.after_m))
    rows: list[tuple[str, ...]] = [("the recording", before, after, "yes")]
    for name, each in controls.items():
        named = NOTHING if each.named is None else f"in {each.named} of {each.of}"
        rows.append((CONTROLS[name], number(each.before), number(each.after), named))
    return rows


def _conclusion(one: RegimeResult, context: ReportContext, missing: Mapping[str, str]) -> str:
    if one.undetermined:
        return f"Undetermined: {one.undetermined}."
    if one.regime in missing:
        return f"Not tested: {missing[one.regime]}."
    if one.regime == "sensing":
        return _sensing(one, missing) + _rest(one, "After correction")
    rest = _rest(one, "With the laws found" if one.findings else "With the refitted parameters")
    if one.findings:
        return f"Physics is missing here: {', '.join(with_description(each.mechanism) for each in one.findings)}.{rest}"
    if not one.defaults:
        return f"The simulator's laws explain this regime with parameters other than {context.reference}.{rest}"
    if rest:
        return f"No missing physics is found here.{_rest(one, 'However')}"
    return f"{context.simulator} explains this regime to the noise of the sensors."


def _rest(one: RegimeResult, after: str) -> str:
    """Return a sentence on the cross-validation residuals, "" if they are noise."""
    times = one.times_noise
    return f" {after}, {residual_words(times)}." if times and times > RESIDUALS.as_noise else ""


def _sensing(one: RegimeResult, missing: Mapping[str, str]) -> str:
    """Return the conclusion on the sensors; which faults were tested depends on the recorded streams."""
    found = "The measured wall positions and the repetition of frames show no sensor fault."
    if one.findings:
        found = f"Sensor faults: {', '.join(with_description(each.mechanism) for each in one.findings)}."
    if missing.get("gantry") == NO_PATH:
        return f"{found} Not tested: the camera's delay and clock, since {NO_PATH}."
    untested = one.next_recording and not one.findings
    return f"{found} Not tested: the camera's delay and clock." if untested else found


def _residuals(one: Mismatch) -> dict[str, Any]:
    shown = [label for label, x in one.by.items() if len(np.unique(x[np.isfinite(x)])) > 1]
    maps = map_arrows(one) if one.place is not None and one.size is not None else {}
    return {
        "unchanged": unchanged(one),
        "what": one.what,
        "unit": one.unit,
        "how_to_read": _how_to_read(one),
        "maps": [(name, number(arrows.scale), map_picture(one, name, arrows)) for name, arrows in maps.items()],
        "panels": [(label, residual_pictures(one, label)) for label in shown],
    }


def _how_to_read(one: Mismatch) -> str:
    target = "noise alone gives one" if one.components == ("rms",) else "explained residuals are zero"
    return f"Means of {len(one.before)} {one.of}, ±2 standard errors; {target}."
