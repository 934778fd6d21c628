"""What a variant is, as plain data: the facts of its page and of `puckpilot envs --json`, taken from the tables."""

from __future__ import annotations

import importlib
import inspect
from collections.abc import Callable
from typing import Any

from puckpilot_env import parameters
from puckpilot_env.game import observation, reward, sensing
from puckpilot_env.game.predict import MISSES, SAVED, SCORES
from puckpilot_env.game.rules import (
    CLEAR,
    CLOCK,
    CONCEDED,
    ENDING_NAMES,
    LOST,
    MISSED,
    POINTS,
    SHOT,
    STEP_LIMIT,
)
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.physics.effects import EFFECTS
from puckpilot_env.tables import ACTION_COLUMNS, _action_bounds
from puckpilot_env.variants import Variant

SENSING = {
    sensing.EXACT: "exact and immediate",
    sensing.ESTIMATED: "camera frames, late and noisy; velocities are estimated from them",
    sensing.HISTORY: "a history of camera frames, late and noisy; no velocities",
}
ENDINGS = {
    DEFENCE: (CLEAR, CONCEDED, LOST),
    ATTACK: (SHOT, MISSED, CONCEDED),
    MATCH: (POINTS, CLOCK),
}
SPARSE_REWARDS = {
    **dict.fromkeys((DEFENCE, ATTACK), "1 for the winner of the drill and -1 for the loser, when it ends"),
    MATCH: "1 for a goal, and -1 for the conceder",
}
# Who gets a term, by game; a term that is absent cannot occur there.
_EACH_STEP = "both, at every step"
_IN_MATCH = "both"
RECEIVERS: dict[str, dict[int, str]] = {
    "clear_reward": {
        DEFENCE: "player_0; ends the episode",
        MATCH: _IN_MATCH,
    },
    "conceded_reward": {
        DEFENCE: "who concedes; ends the episode",
        ATTACK: "who concedes; ends the episode",
        MATCH: _IN_MATCH,
    },
    "scored_reward": {MATCH: _IN_MATCH},
    "foul_reward": {MATCH: _IN_MATCH},
    "possession_lost_reward": {
        DEFENCE: "player_0; ends the episode",
        MATCH: _IN_MATCH,
    },
    "shot_reward": {
        DEFENCE: "player_1, for the shot that begins the episode",
        ATTACK: "player_0; ends the episode",
        MATCH: _IN_MATCH,
    },
    "movement_cost": {game: _EACH_STEP for game in (DEFENCE, ATTACK, MATCH)},
    "voltage_cost": {game: _EACH_STEP for game in (DEFENCE, ATTACK, MATCH)},
}
# Example inputs of the terms that depend on something, with the words for them.
EXAMPLES: dict[str, tuple[float, str]] = {
    "speed": (3.0, "at 3 m/s"),
    "mallet_x": (0.2, ""),
    "mallet_y": (0.3, ""),
    "target_x": (0.5, "for a way of 0.5 m"),
    "target_y": (0.7, ""),
    "volts_x": (6.0, ""),
    "volts_y": (8.0, "for 6 V and 8 V"),
}
OUTCOMES = {SCORES: "would score", SAVED: "would be saved", MISSES: "would miss"}
INFOS_AT_END = (
    ("ending", "name of the ending, see above"),
    ("winner", "`player_0`, `player_1` or None"),
    ("outcome", "1 won, 0 nobody won, -1 lost"),
    ("is_success", "whether it won"),
    ("score", "(own points, opponent's points)"),
    ("fouls", "(own, the opponent's): how often each held the puck for too long"),
)
INFOS_AT_RESET = (
    ("parameters", "the drawn parameters by name"),
    ("gantry_scale", "(2, 3) float64: own C5, C6, C7 of axes x and y relative to the parameters'"),
    ("camera_delay", "from exposure of the newest frame to the first decision [s]"),
)


def describe(variant: Variant) -> dict[str, Any]:
    """Everything about a variant that a program may want to know; numbers, strings, lists and dicts alone."""
    nominal = parameters.make_records(1, variant.parameters)[0]
    low, high = _action_bounds(nominal)
    return {
        "id": variant.id,
        "module": f"puckpilot_env.{variant.module}",
        "title": title(variant),
        "summary": variant.summary,
        "prose": prose(variant),
        "ending": variant.ending,
        "endings": endings(variant),
        "period": variant.period,
        "step_limit": variant.step_limit,
        "sensing": SENSING[variant.sensing],
        "observation": [vars(column) for column in observation.columns(variant.rules()[0], nominal)],
        "action": [
            {"name": name, "unit": unit, "low": float(low[i]), "high": float(high[i]), "meaning": meaning}
            for i, (name, unit, meaning) in enumerate(ACTION_COLUMNS)
        ],
        "rewards": [
            {
                "name": name,
                "meaning": first_paragraph(term),
                "size": size(term),
                "receiver": RECEIVERS[name][variant.game],
            }
            for name, term in reward_terms().items()
            if variant.game in RECEIVERS[name]
        ],
        "sparse_rewards": SPARSE_REWARDS[variant.game],
        "parameters": [
            {**vars(row), "default": float(nominal[row.name]), "usual": row.default}
            for row in parameters.TABLE
            if row not in parameters.EFFECT_ROWS
        ],
        "effects": [
            {
                "name": name,
                "regime": effect.regime,
                "law": effect.law,
                "listed": effect.listed,
                "numbers": [{"short": short, **vars(row)} for short, row in effect.rows.items()],
            }
            for name, effect in EFFECTS.items()
            if not effect.not_simulated
        ],
        "draws": [{**vars(draw), "unit": parameters.BY_NAME[draw.parameter].unit} for draw in variant.draws],
        "infos_at_reset": dict(INFOS_AT_RESET) if variant.draws else {},
        "infos_at_end": dict(INFOS_AT_END),
        "history": list(variant.history),
    }


def title(variant: Variant) -> str:
    """The first line of the module's docstring."""
    return _docstring(variant).partition("\n")[0].rstrip(".")


def prose(variant: Variant) -> str:
    """The module's docstring after its first line."""
    return _docstring(variant).partition("\n")[2].strip()


def _docstring(variant: Variant) -> str:
    module = importlib.import_module(f"puckpilot_env.{variant.module}")
    return inspect.cleandoc(module.__doc__ or variant.summary)


def endings(variant: Variant) -> list[str]:
    """Names of the endings that can occur; the step limit among them where the variant has one."""
    found = (*ENDINGS[variant.game], STEP_LIMIT) if variant.step_limit else ENDINGS[variant.game]
    return [ENDING_NAMES[ending] for ending in found]


def reward_terms() -> dict[str, Callable[..., float]]:
    """The functions of `game.reward` that are terms of the reward, in the order of the file."""
    return {name: term for name, term in vars(reward).items() if name.endswith(("_reward", "_cost"))}


def first_paragraph(term: Callable[..., float]) -> str:
    """What a term says of itself, on one line."""
    return " ".join((inspect.getdoc(term) or "").partition("\n\n")[0].split())


def size(term: Callable[..., float]) -> str:
    """What a term amounts to: its value if it is constant, otherwise that of an example."""
    names = list(inspect.signature(term).parameters)
    values = {name: EXAMPLES[name][0] for name in names if name != "outcome"}
    words = " ".join(EXAMPLES[name][1] for name in values if EXAMPLES[name][1])
    if "outcome" not in names:
        return f"{term(*values.values()):.4g} {words}".strip()
    cases = [f"{term(*values.values(), outcome):.4g} if it {what}" for outcome, what in OUTCOMES.items()]
    return f"{words}: {', '.join(cases)}"
