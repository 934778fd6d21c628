"""A diagnosis as files: diagnosis.json in the format puckpilot-diagnosis/1, and effects.toml for the simulator."""

from __future__ import annotations

import json
from dataclasses import asdict
from pathlib import Path
from typing import Any

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.diagnosis import Diagnosis
from sim2real.diagnose.finding import Estimate, Finding

FORMAT = "puckpilot-diagnosis/1"
EFFECTS_FORMAT = "puckpilot-effects/1"


def as_dict(diagnosis: Diagnosis) -> dict[str, Any]:
    """The diagnosis in the format's own words."""
    proof = diagnosis.proof
    baseline = {name: one for each in diagnosis.accounts for name, one in each.baseline.items()}
    words = {
        "format": FORMAT,
        "verdict": diagnosis.verdict,
        "baseline": {"parameters": {name: _estimate(one) for name, one in baseline.items()}},
        "findings": [_finding(one) for one in diagnosis.findings],
        "heldout": None if proof is None else asdict(proof),
        "next_recording": diagnosis.next_recording,
    }
    if diagnosis.reason:
        words["reason"] = diagnosis.reason
    return words


def _finding(one: Finding) -> dict[str, Any]:
    return {
        "regime": one.regime,
        "where": dict(one.where),
        "mechanism": one.mechanism,
        "also_possible": list(one.also_possible),
        "depends_on": list(one.depends_on),
        "formula": one.formula,
        "parameters": {name: _estimate(value) for name, value in one.parameters.items()},
        "p_value": one.p_value,
        "heldout": {"before": one.before, "after": one.after, "unit": "rms in units of the sensor's noise"},
    }


def _estimate(one: Estimate) -> dict[str, Any]:
    return {"value": one.value, "low": one.low, "high": one.high, "unit": one.unit}


def effects_toml(diagnosis: Diagnosis) -> str:
    """The refitted baseline and the effects found, as the simulator takes them; what it cannot take, as a comment."""
    lines = [f'format = "{EFFECTS_FORMAT}"', "", "[parameters]"]
    for each in diagnosis.accounts:
        lines += [f"{name} = {one.value!r}" for name, one in each.baseline.items()]
    for one in diagnosis.findings:
        if one.mechanism in EFFECTS and EFFECTS[one.mechanism].not_simulated:
            lines += ["", f"# {one.mechanism} is left out: {EFFECTS[one.mechanism].not_simulated}"]
        elif one.mechanism in EFFECTS:
            label = {row.name: key for key, row in EFFECTS[one.mechanism].rows.items()}
            lines += ["", f"[effects.{one.mechanism}]"]
            lines += [f"{label[name]} = {float(value)!r}" for name, value in one.values.items() if name in label]
    return "\n".join(lines) + "\n"


def write(diagnosis: Diagnosis, folder: Path) -> list[Path]:
    """Write all files into `folder`, each whole or not at all; returns their places."""
    folder.mkdir(parents=True, exist_ok=True)
    texts = {
        "diagnosis.json": json.dumps(as_dict(diagnosis), indent=1, allow_nan=False) + "\n",
        "effects.toml": effects_toml(diagnosis),
    }
    return [_write_whole(folder / name, text) for name, text in texts.items()]


def _write_whole(path: Path, text: str) -> Path:
    draft = path.with_name(f".{path.name}.part")
    draft.write_text(text, encoding="utf-8")
    draft.replace(path)
    return path
