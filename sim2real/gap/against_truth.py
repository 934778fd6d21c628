"""What a diagnosis named beside what a concealed table has, and what the arm `corrected` makes of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from puckpilot_env.options.at_table import AT_TABLE
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS
from puckpilot_env.physics.effects import EFFECTS
from sim2real.gap.arms import OWN, simulator_of
from sim2real.gap.gap_table import GapTable
from sim2real.table.twin.concealed import ConcealedTable

NAMED, POSSIBLE, MISSED, NOT_THERE = "named", "named as another possibility", "missed", "not there"
CAMERA_DELAY = "camera_delay"
UNLISTED = "unlisted"  # mechanism of all laws without a name


def against_truth(findings: Sequence[Mapping[str, Any]], table: ConcealedTable) -> list[dict[str, Any]]:
    """A row for each effect that the concealed `table` has or a diagnosis named, those that are there first.

    effect: its name, of an unlisted law "unlisted" and its regime; outcome: NAMED, POSSIBLE, MISSED or NOT_THERE;
    numbers: by their short names, `unit` and the `truth` beside what was `found`, {value, low, high}, None if it was
    not; of an unlisted law there are none.
    """
    there = _there(table)
    found: dict[str, Mapping[str, Any]] = {}
    for one in findings:
        found.setdefault(_name(one["mechanism"], one["regime"]), one)
    possible = {other for one in findings for other in one["also_possible"]}
    rows = []
    for name in [*there, *(one for one in found if one not in there)]:
        outcome = (NAMED if name in there else NOT_THERE) if name in found else MISSED
        outcome = POSSIBLE if outcome == MISSED and name in possible else outcome
        numbers = _numbers(name, there.get(name, {}), found[name]["parameters"] if name in found else {})
        rows.append({"effect": name, "outcome": outcome, "numbers": numbers})
    return rows


def learnt(circle: Path, table: GapTable) -> dict[str, Any]:
    """What the arm `corrected` of the circle in a folder learns on beyond what is true of every table.

    effects: those that are switched on; constants: of the baseline, by name, that differ from the simulator's, or from
    what is known of the table; draws: [low, high] by name."""
    simulator = simulator_of(OWN, circle, table)
    assert simulator is not None
    values = {name: value for name, value in simulator.values.items() if name not in AT_TABLE}
    known = {name: table.parameters.get(name, BY_NAME[name].default) for name in values}
    changed = {name for name, value in values.items() if value != known[name]}
    draws = simulator.draws["draws"] if simulator.draws else {}
    return {
        "effects": [name for name, effect in EFFECTS.items() if changed.intersection(effect.row_names)],
        "constants": {name: values[name] for name in values if name in changed and BY_NAME[name] not in EFFECT_ROWS},
        "draws": {name: [row["low"], row["high"]] for name, row in draws.items()},
    }


def _name(mechanism: str, regime: str) -> str:
    return f"{UNLISTED}, {regime}" if mechanism == UNLISTED else mechanism


def _there(concealed: ConcealedTable) -> dict[str, dict[str, float]]:
    """The effects that a concealed table has, with all their numbers by their short names."""
    there = {}
    for name, effect in EFFECTS.items():
        numbers = {short: concealed.truth.get(row.name, row.default) for short, row in effect.rows.items()}
        if any(numbers[short] != row.default for short, row in effect.rows.items()):
            there[name if effect.listed else _name(UNLISTED, effect.regime)] = numbers if effect.listed else {}
    if concealed.errors.stamp_late:
        there[CAMERA_DELAY] = {"delay_s": concealed.errors.stamp_late}
    return there


def _numbers(
    effect: str, truth: Mapping[str, float], found: Mapping[str, Mapping[str, Any]]
) -> dict[str, dict[str, Any]]:
    """An effect's numbers that are off their defaults or were found."""
    units = {short: (row.unit, row.default) for short, row in EFFECTS[effect].rows.items()} if effect in EFFECTS else {}
    units |= {"delay_s": ("s", 0.0)} if effect == CAMERA_DELAY else {}
    return {
        short: {
            "unit": unit,
            "truth": truth.get(short, default),
            "found": {key: found[short][key] for key in ("value", "low", "high")} if short in found else None,
        }
        for short, (unit, default) in units.items()
        if short in found or truth.get(short, default) != default
    }
