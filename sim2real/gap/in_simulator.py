"""A player's score in the simulator, on tables without an effect and on those with what a table conceals: beside its
score on that table it shows which stage lost what."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.variants import find_variant
from sim2real.table.player_file import player_digest
from sim2real.table.simulated import play_simulated

UNCHANGED, TRUTH = "unchanged", "truth"


def simulate(
    path: Path,
    variant: str,
    player: str,
    opponents: Sequence[str],
    games: int,
    seed: int,
    tables: Mapping[str, Mapping[str, float]],
) -> None:
    """Play `games` against each of the opponents on each kind of `tables`, UNCHANGED or the TRUTH with its parameters,
    and write goals and minutes as the file `path`, if that has not those of this player already."""
    digest = player_digest(player)
    if path.exists() and json.loads(path.read_text(encoding="utf-8")).get("player") == digest:
        return
    played = {
        name: {one: _goals(variant, player, one, games, seed, effects) for one in opponents}
        for name, effects in tables.items()
    }
    path.parent.mkdir(parents=True, exist_ok=True)
    write_text_whole(path, json.dumps({"player": digest, "tables": played}, indent=1) + "\n")


def simulated_rates(path: Path) -> dict[str, dict[str, float]]:
    """Goals a minute `scored` and `conceded` on tables UNCHANGED and, where the simulator has any of it, of the TRUTH,
    the mean over opponents."""
    content = json.loads(path.read_text(encoding="utf-8"))
    return {name: _rates(list(one.values())) for name, one in content["tables"].items()}


def _rates(against: list[dict[str, Any]]) -> dict[str, float]:
    return {
        name: sum(one["goals"][side] / one["minutes"] for one in against) / len(against)
        for side, name in enumerate(("scored", "conceded"))
    }


def _goals(
    variant: str, player: str, opponent: str, games: int, seed: int, effects: Mapping[str, float]
) -> dict[str, Any]:
    match = play_simulated(variant, player, opponent, games, seed, effects)
    return {"goals": list(match.goals), "minutes": float(match.lengths.sum()) * find_variant(variant).period / 60.0}
