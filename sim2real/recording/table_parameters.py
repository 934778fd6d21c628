"""The simulator's parameters for the table that a recording was made on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files import small_file
from puckpilot_env.files.toml_file import refuse_unknown, section
from puckpilot_env.options import profile_file
from puckpilot_env.options.draws_file import FORMAT as DRAWS_FORMAT
from puckpilot_env.options.effects_file import FORMAT as EFFECTS_FORMAT
from puckpilot_env.parameters import TABLE, checked
from sim2real.recording.checks import FORMAT
from sim2real.recording.folder import Recording

FROM_META = {
    "length": ("table", "length_m"),
    "width": ("table", "width_m"),
    "goal_width": ("table", "goal_width_m"),
    "puck_radius": ("puck", "radius_m"),
    "mallet_radius": ("mallet", "radius_m"),
    "max_voltage": ("gantry", "supply_V"),
    "pulley_radius": ("gantry", "pulley_radius_m"),
}


def parameters(recording: Recording, defaults: Mapping[str, float] | None = None) -> dict[str, float]:
    """Parameters by name: the simulator's defaults, updated by `defaults`, then by the sizes in the recording."""
    return {row.name: row.default for row in TABLE} | dict(defaults or {}) | stated_sizes(recording)


def stated_sizes(recording: Recording) -> dict[str, float]:
    """The sizes that the recording states, by parameter name."""
    stated = {name: recording.nominal(section, key) for name, (section, key) in FROM_META.items()}
    return {name: value for name, value in stated.items() if value is not None}


def recording_meta(p: np.void, frame_rate: float, note: str) -> dict[str, Any]:
    """The content of meta.json for a table of these parameters, whose camera has so many frames a second."""
    meta: dict[str, Any] = {"format": FORMAT}
    for name, (part, key) in FROM_META.items():
        meta.setdefault(part, {})[key] = float(p[name])
    return meta | {"camera": {"rate_hz": frame_rate, "position_std_m": None, "place_std_m": None}, "note": note}


def read_baseline(path: Path) -> dict[str, float]:
    """Read parameters by name from a TOML file of lines like `friction = 0.1`, from an effects.toml without effects, or
    from a profile.

    Raises ValueError, in one line, for any other file.
    """
    try:
        text = small_file.read_text(path)
    except OSError as error:
        words = f"cannot read the baseline '{path}': {error.strerror or error}"
        raise ValueError(f"{words}; expected a TOML file of lines like 'friction = 0.1'") from error
    try:
        found = small_file.parse_toml(text)
    except ValueError as error:
        raise ValueError(f"{path}: not a TOML file ({error}); expected lines like 'friction = 0.1'") from error
    try:
        return {name: checked(name, value) for name, value in _numbers(path, found).items()}
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error


def _numbers(path: Path, found: Mapping[str, Any]) -> Mapping[str, Any]:
    """The values of a file by parameter. Raises ValueError, with what to do, for a file with other content."""
    alone = "give --baseline a file with [parameters] alone; to play with this one: puckpilot match A B"
    if found.get("format") == DRAWS_FORMAT:
        raise ValueError(f"contains ranges to draw from, not the parameters of one table: {alone} --draws {path}")
    if found.get("format") == profile_file.FORMAT:
        return profile_file.from_content(found).parameters
    if found.get("format") != EFFECTS_FORMAT:
        return found
    refuse_unknown(found, ("format", "parameters", "effects"), "entry")
    if section(found, "effects"):
        names = ", ".join(section(found, "effects"))
        raise ValueError(f"contains effects ({names}), which diagnose identifies itself: {alone} --effects {path}")
    return section(found, "parameters")
