"""Tables with an effect that is concealed from who plays: which there are, and what was in which game.

Each is of a size that one feels in play. What was concealed is kept beside the recordings, not in them.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from puckpilot_env.files.whole_file import write_text_whole

FOLDER = "concealed"  # in that of the arena's recordings


@dataclass(frozen=True)
class Concealed:
    """words: what is in the table, plainly; mechanism: how a diagnosis names it, "" where there is nothing to find;
    parameters: by the simulator's names."""

    words: str
    mechanism: str = ""
    parameters: Mapping[str, float] = field(default_factory=dict)


_PATCH = {"patch_x": 0.7, "patch_y": 0.6, "patch_radius": 0.25, "patch_extra": 1.5}
_TIRED = {"restitution_slope": 0.1}
_SOFT = {"mallet_restitution_slope": 0.08}
TABLES = (
    Concealed("nothing: the table is as the simulator has it"),
    Concealed("a tilt: the table is not level", "table_tilt", {"tilt_x": 0.05, "tilt_y": -0.18}),
    Concealed("a warp: the table is not flat", "table_warp", {"warp_xx": -0.3, "warp_yy": 0.6}),
    Concealed("walls that rub and turn the puck", "wall_friction_spin", {"wall_mu": 0.3}),
    Concealed("tired walls, which lose more the faster the hit", "speed_dependent_restitution", _TIRED),
    Concealed("one dead wall", "wall_to_wall_restitution", {"restitution_y1": -0.35}),
    Concealed("soft mallets, which lose more the faster the strike", "mallet_speed_restitution", _SOFT),
    Concealed("mallets whose rims rub", "mallet_friction", {"mallet_mu": 0.3}),
    Concealed("a patch that brakes the puck", "friction_patch", _PATCH),
    Concealed("a puck that swerves", "side_force", {"side_force": 0.3}),
    Concealed("thick air, which drags", "linear_drag", {"linear_drag": 0.4}),
)


def draw(seed: int) -> Concealed:
    """The table of the game with this seed."""
    return TABLES[int(np.random.default_rng(seed).integers(len(TABLES)))]


def keep(folder: Path, name: str, table: Concealed) -> None:
    """Keep what is concealed in the game whose recording in `folder` has this name. OSError if that cannot be."""
    content = {"words": table.words, "mechanism": table.mechanism, "parameters": dict(table.parameters)}
    (folder / FOLDER).mkdir(exist_ok=True)
    write_text_whole(folder / FOLDER / f"{name}.json", json.dumps(content, indent=1) + "\n")


def revealed(folder: Path, name: str) -> dict[str, object] | None:
    """What was kept of a game, None if nothing was concealed in it."""
    file = folder / FOLDER / f"{name}.json"
    found: dict[str, object] | None = json.loads(file.read_text()) if file.is_file() else None
    return found
