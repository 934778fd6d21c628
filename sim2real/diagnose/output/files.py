"""The files of a diagnosis: diagnosis.json (puckpilot-diagnosis/1), report.html, effects.toml with parameters for the
simulator, and draws.toml with their distribution."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from sim2real.diagnose.output.draws_toml import draws_toml
from sim2real.diagnose.output.effects_toml import effects_toml
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.result.context import PLAIN, ReportContext
from sim2real.diagnose.result.result import Curve, Estimate, Finding, Proof, RegimeResult
from sim2real.diagnose.result.untested import untested

FORMAT = "puckpilot-diagnosis/1"
NO_PIECES = Proof(0.0, 0.0, 0.0, 0)


def as_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """Return the diagnosis in the format puckpilot-diagnosis/1."""
    proof = diagnosis.proof
    baseline = {name: one for each in diagnosis.regime_results for name, one in each.baseline.items()}
    entries: dict[str, Any] = {
        "format": FORMAT,
        "verdict": diagnosis.verdict,
        "baseline": {"parameters": {name: _estimate(one) for name, one in baseline.items()}},
        "findings": [_finding(one) for one in diagnosis.findings],
        "regimes": _regimes(diagnosis),
        "heldout": asdict(proof or NO_PIECES) if diagnosis.findings or proof else None,
        "next_recording": diagnosis.next_recording,
    }
    if diagnosis.proof_remarks:
        entries["heldout_notes"] = diagnosis.proof_remarks
    if diagnosis.reason:
        entries["reason"] = diagnosis.reason
    if diagnosis.remarks:
        entries["notes"] = diagnosis.remarks
    return entries


def _finding(one: Finding) -> dict[str, Any]:
    entries = {
        "regime": one.regime,
        "where": dict(one.where),
        "mechanism": one.mechanism,
        "also_possible": list(one.also_possible),
        "depends_on": list(one.depends_on),
        "formula": one.formula,
        "parameters": {name: _estimate(value) for name, value in one.parameters.items()},
        "p_value": one.p_value,
        **({} if one.size_m is None else {"size_m": one.size_m}),
        "heldout": {
            "before": one.before,
            "after": one.after,
            "unit": "rms in units of the sensor's noise",
            **{f"{name}_control": _without_none(asdict(control)) for name, control in one.null_controls.items()},
        },
    }
    return entries if one.curve is None else {**entries, "curve": _curve(one.curve)}


def _regimes(diagnosis: Diagnosis) -> list[dict[str, Any]]:
    """Return the result of each regime, and for regimes that were not tested the reason."""
    missing = untested(diagnosis)
    tested = [_regime(one) for one in diagnosis.regime_results if one.regime not in missing]
    return [*tested, *({"regime": name, "verdict": "untested", "reason": why} for name, why in missing.items())]


def _regime(one: RegimeResult) -> dict[str, Any]:
    """Return the result of one regime."""
    entries = {
        "regime": one.regime,
        "verdict": one.verdict,
        "baseline": {name: _estimate(value) for name, value in one.baseline.items()} or None,
        "reason": one.undetermined or None,
        "heldout": None if one.proof is None else asdict(one.proof),
        "doubt": one.doubt or None,
        "minor": one.minor or None,
        "next_recording": one.next_recording or None,
    }
    return _without_none(entries)


def _without_none(entries: dict[str, Any]) -> dict[str, Any]:
    return {key: value for key, value in entries.items() if value is not None}


def _curve(one: Curve) -> dict[str, Any]:
    """Return the law as a curve with its 95 % band."""
    entries = {"x_label": one.x_label, "y_label": one.y_label, **({"ticks": list(one.ticks)} if one.ticks else {})}
    return {**entries, **{name: getattr(one, name).tolist() for name in ("x", "y", "low", "high")}}


def _estimate(one: Estimate) -> dict[str, Any]:
    return {"value": one.value, "low": one.low, "high": one.high, "unit": one.unit}


def write(diagnosis: Diagnosis, folder: Path, context: ReportContext = PLAIN) -> list[Path]:
    """Write all files into `folder`, each atomically, and return their paths; diagnosis.json comes last, so that where
    it is, the others are, too."""
    from sim2real.diagnose.report.page import page
    from sim2real.diagnose.report.summary import what_was_found

    folder.mkdir(parents=True, exist_ok=True)
    content = as_dict(diagnosis) | {"summary": what_was_found(diagnosis, context)}
    texts = {
        "diagnosis.json": json.dumps(content, indent=1, allow_nan=False) + "\n",
        "report.html": page(diagnosis, context),
        "effects.toml": effects_toml(diagnosis),
        "draws.toml": draws_toml(diagnosis, context),
    }
    paths = {name: write_text_whole(folder / name, texts[name]) for name in reversed(texts)}
    return [paths[name] for name in texts]
