"""The simulator's parameters for the table that a recording was made on."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from puckpilot_env.files import small_file
from puckpilot_env.files.toml_file import refuse_unknown, section
from puckpilot_env.options.draws_file import FORMAT as DRAWS_FORMAT
from puckpilot_env.options.effects_file import FORMAT as EFFECTS_FORMAT
from puckpilot_env.parameters import TABLE, checked
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
    """Parameters by name: the simulator's own, then `defaults`, then the sizes that the recording states."""
    return {row.name: row.default for row in TABLE} | dict(defaults or {}) | stated_sizes(recording)


def stated_sizes(recording: Recording) -> dict[str, float]:
    """The sizes that the recording states, by the names of parameters."""
    stated = {name: recording.nominal(section, key) for name, (section, key) in FROM_META.items()}
    return {name: value for name, value in stated.items() if value is not None}


def read_baseline(path: Path) -> dict[str, float]:
    """Parameters by name from a TOML file of lines like `friction = 0.1`, or of a diagnosis's effects.toml that holds
    no effects. ValueError, in one line, if it is neither."""
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
    """The values of a file by parameter. ValueError, with what to do, for one that holds more."""
    alone = "give --baseline a file of its [parameters] alone; to play with it, puckpilot match A B"
    if found.get("format") == DRAWS_FORMAT:
        raise ValueError(f"holds ranges to draw from, not one table's numbers: {alone} --draws {path}")
    if found.get("format") != EFFECTS_FORMAT:
        return found
    refuse_unknown(found, ("format", "parameters", "effects"), "entry")
    if section(found, "effects"):
        names = ", ".join(section(found, "effects"))
        raise ValueError(f"holds effects ({names}), which diagnose looks for by itself: {alone} --effects {path}")
    return section(found, "parameters")
