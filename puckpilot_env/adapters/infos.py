"""What environments tell beside observations and rewards: what was drawn for an episode, and how one ended."""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.game.rules import ENDING_NAMES
from puckpilot_env.game.sensing import first_delay
from puckpilot_env.tables import Tables

AGENTS = ("player_0", "player_1")
_ENDINGS = np.array(ENDING_NAMES, dtype=object)
_WINNERS = np.array([*AGENTS, None], dtype=object)  # of -1, the last: nobody


def drawn_info(tables: Tables, seats: NDArray[np.integer]) -> dict[str, Any]:
    """What was drawn for the running episodes, as seen from `seats` (n,): arrays with a row a table, copies.

    Randomized `parameters`, the player's own `gantry_scale` (see `state.TABLE`), and the `camera_delay` [s]. Empty for
    a variant that draws nothing.
    """
    if not tables.variant.draws:
        return {}
    p, states = tables.params, tables.states
    return {
        "parameters": {draw.parameter: p[draw.parameter].copy() for draw in tables.variant.draws},
        "gantry_scale": states["gantry_scale"][np.arange(len(tables)), seats],
        "camera_delay": first_delay(states["frame_phase"], p),
    }


def outcome_info(tables: Tables, seats: NDArray[np.integer]) -> dict[str, Any]:
    """How the episodes that ended in the last step did so, for the players in `seats` (n,): arrays with a row a table.

    `ending` in words, `winner` by name or None, `outcome` (1 won, 0 nobody won, -1 lost), `is_success` (whether it
    won, as Stable-Baselines3 asks for), `score` (n, 2) and `fouls` (n, 2), the player's own first. Rows of tables whose
    episode goes on mean nothing.
    """
    states, rows = tables.states, np.arange(len(tables))
    last = "last_" if tables.autoreset else ""
    score, fouls = states[f"{last}score"], states[f"{last}fouls"]
    winner = states["winner"]
    return {
        "ending": _ENDINGS[states["ending"]],
        "winner": _WINNERS[winner],
        "outcome": np.where(winner < 0, 0, np.where(winner == seats, 1, -1)),
        "is_success": winner == seats,
        "score": np.stack([score[rows, seats], score[rows, 1 - seats]], axis=1),
        "fouls": np.stack([fouls[rows, seats], fouls[rows, 1 - seats]], axis=1),
    }


def only_row(info: dict[str, Any]) -> dict[str, Any]:
    """The info of the first table, as plain numbers and arrays of its own."""
    row = {}
    for key, value in info.items():
        first = only_row(value) if isinstance(value, dict) else value[0]
        row[key] = first.item() if isinstance(first, np.generic) else first
    return row


def masked(info: dict[str, Any], mask: NDArray[np.bool_]) -> dict[str, Any]:
    """The info of the tables in `mask` (n,) in Gymnasium's convention for vectors.

    Beside each key `k` stands the mask as `_k`; the other rows are 0, or None of objects.
    """
    rows: dict[str, Any] = {}
    for key, value in info.items():
        if isinstance(value, dict):
            rows[key] = masked(value, mask)
        else:
            rows[key] = np.full_like(value, None if value.dtype == object else 0)
            rows[key][mask] = value[mask]
        rows[f"_{key}"] = mask.copy()
    return rows
