"""Raw outputs: one file `results/raw/ID.json` for each run, whole or not at all."""

from __future__ import annotations

import json
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole

FORMAT = "puckpilot-result/1"


@dataclass(frozen=True)
class Raw:
    """What one run printed, and where that came from.

    `commit` of the repository, `date` in UTC (ISO 8601), `seconds` that the run took, its exit `status`, and the
    `machine` (see `provenance.py`). `output`: what JSON holds, or text.
    """

    id: str
    command: tuple[str, ...]
    seed: int | None
    commit: str
    date: str
    seconds: float
    status: int
    machine: dict[str, Any]
    output: Any


def raw_folder(root: Path) -> Path:
    """Where the raw outputs of the repository `root` lie."""
    return root / "results" / "raw"


def read_raws(root: Path) -> dict[str, Raw]:
    """All raw outputs, by the id of their run. ValueError, in one line, for a file that is none."""
    return {path.stem: _read(path) for path in sorted(raw_folder(root).glob("[!.]*.json"))}


def write_raw(root: Path, raw: Raw) -> Path:
    """Write a raw output to its place, and return that."""
    folder = raw_folder(root)
    folder.mkdir(parents=True, exist_ok=True)
    text = json.dumps({"format": FORMAT} | asdict(raw), indent=1, ensure_ascii=False)
    return write_text_whole(folder / f"{raw.id}.json", text + "\n")


def _read(path: Path) -> Raw:
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
        if content.pop("format") != FORMAT:
            raise ValueError
        raw = Raw(**content | {"command": tuple(content["command"])})
    except (ValueError, KeyError, TypeError, AttributeError):
        raise ValueError(f"{path}: is no raw output; expected what `python -m results run` writes") from None
    if raw.id != path.stem:
        raise ValueError(f"{path}: is the output of '{raw.id}'; expected it in {raw.id}.json")
    return raw
