"""A diagnosis as `puckpilot diagnose` writes it, but made at once, of what is known to be in a table."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

LINES = ["The simulator lacks table_tilt (the table is not level).", "  next: no further recording is needed"]

REPORT = "<p>what was found</p><script>alert()</script>"


def write_diagnosis(folder: Path, effects: Mapping[str, Mapping[str, float]], *more: str) -> Path:
    """Write a diagnosis that found these effects, with `more` lines in its effects.toml."""
    folder.mkdir(parents=True)
    lines = ['format = "puckpilot-effects/1"']
    for name, numbers in effects.items():
        lines += [f"[effects.{name}]", *(f"{key} = {value}" for key, value in numbers.items())]
    (folder / "effects.toml").write_text("\n".join([*lines, *more]) + "\n")
    (folder / "diagnosis.json").write_text(json.dumps({"format": "puckpilot-diagnosis/1", "summary": LINES}))
    (folder / "report.html").write_text(REPORT)
    return folder
