"""The simulator's numbers for the table that a recording was made on."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from pathlib import Path

from puckpilot_env.draws_file import FORMAT as DRAWS_FORMAT
from puckpilot_env.effects_file import FORMAT as EFFECTS_FORMAT
from puckpilot_env.parameters import TABLE, checked
from sim2real.recording import Recording

FROM_META = {
    "length": ("table", "length_m"),
    "width": ("table", "width_m"),
    "goal_width": ("table", "goal_width_m"),
    "puck_radius": ("puck", "radius_m"),
    "mallet_radius": ("mallet", "radius_m"),
    "max_voltage": ("gantry", "supply_V"),
    "pulley_radius": ("gantry", "pulley_radius_m"),
}


def parameters(recording: Recording, shipped: Mapping[str, float] | None = None) -> dict[str, float]:
    """Parameters by name: `shipped` or the defaults, with the sizes that the recording states."""
    return {row.name: row.default for row in TABLE} | dict(shipped or {}) | stated_sizes(recording)


def stated_sizes(recording: Recording) -> dict[str, float]:
    """The sizes that the recording states, by the names of parameters."""
    stated = {name: recording.nominal(section, key) for name, (section, key) in FROM_META.items()}
    return {name: value for name, value in stated.items() if value is not None}


def read_baseline(path: Path) -> dict[str, float]:
    """Parameters by name from a TOML file of lines like `friction = 0.1`, or of a diagnosis's effects.toml that holds
    no effects. ValueError, in one line, if it is neither."""
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        words = f"cannot read the baseline '{path}': {error.strerror or error}"
        raise ValueError(f"{words}; expected a TOML file of lines like 'friction = 0.1'") from error
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        raise ValueError(f"{path}: not a TOML file ({error}); expected lines like 'friction = 0.1'") from error
    if found.get("format") == DRAWS_FORMAT:
        raise ValueError(
            f"{path} holds ranges to draw from, not one table's numbers: give --baseline a file of its [parameters] "
            f"alone; to play with it, puckpilot match A B --draws {path}"
        )
    if found.get("format") == EFFECTS_FORMAT:
        unknown = [name for name in found if name not in ("format", "parameters", "effects")]
        if unknown:
            raise ValueError(f"{path}: unknown entry '{unknown[0]}'; expected [parameters] alone")
        if found.get("effects"):
            names = ", ".join(found["effects"])
            raise ValueError(
                f"{path} holds effects ({names}), which diagnose looks for by itself: give --baseline a file of its "
                f"[parameters] alone; to play with it, puckpilot match A B --effects {path}"
            )
        found = found.get("parameters", {})
    try:
        return {name: checked(name, value) for name, value in found.items()}
    except ValueError as error:
        raise ValueError(f"{path}: {error}") from error
