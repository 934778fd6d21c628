"""What a diagnosis found, for the page of a recording: read from the folder that `puckpilot diagnose` wrote."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from puckpilot_env.files import small_file
from puckpilot_env.options.effects_file import NOT_SWITCHED, effect_values
from sim2real.diagnose.output.files import FORMAT

DIAGNOSIS, EFFECTS = "diagnosis.json", "effects.toml"
MOST_BYTES = 1 << 24  # of diagnosis.json, which holds curves


@dataclass(frozen=True)
class Found:
    """summary: the diagnosis in words, a line each; values: the simulator's parameters of what was found, by name;
    left_out: what the simulator cannot be given of it, in words."""

    summary: list[str]
    values: Mapping[str, float]
    left_out: list[str]


def read_diagnosis(folder: Path) -> Found:
    """What is in the folder of a diagnosis. ValueError, in one line, if that cannot be read."""
    try:
        content = json.loads(small_file.read_text(folder / DIAGNOSIS, MOST_BYTES))
        effects = small_file.read_text(folder / EFFECTS).splitlines()
    except OSError as error:
        words = f"{folder}: no diagnosis can be read there ({error.strerror or error})"
        raise ValueError(f"{words}; expected the folder that puckpilot diagnose wrote") from None
    except RecursionError:
        content, effects = None, []
    summary = content.get("summary") if isinstance(content, dict) and content.get("format") == FORMAT else None
    if not isinstance(summary, list) or not all(isinstance(line, str) for line in summary):
        raise ValueError(f"{folder / DIAGNOSIS}: is none of {FORMAT} with a summary; run puckpilot diagnose again")
    left_out = [line.removeprefix(NOT_SWITCHED).strip() for line in effects if line.startswith(NOT_SWITCHED)]
    return Found(summary, effect_values(folder / EFFECTS), left_out)
