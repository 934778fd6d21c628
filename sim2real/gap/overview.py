"""What several circles say together: for each table what was lost, what each arm won back, its share of the ceiling's.

Circles of one table are series of games of different seeds, of which the mean is taken.
The intervals are of these trained players: how much another training would differ is not in them, so the change of each
circle stands beside their mean.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass
from itertools import combinations
from pathlib import Path
from typing import Any

from sim2real.gap.arms import ARMS, CEILING, OWN
from sim2real.gap.circle_folder import BEFORE
from sim2real.gap.gap_table import TWIN
from sim2real.gap.in_simulator import TRUTH
from sim2real.table.score import mean_change, share
from sim2real.table.twin.concealed import TABLES, find_table

FORMAT = "puckpilot-gap-overview/4"
CONTROL = "none"  # the table without an effect, of which nothing is won back
ALIKE = ("player", "opponents", "seconds", "minutes", "steps")  # conditions that all circles share


@dataclass(frozen=True)
class PlayedGame:
    """A game as a circle keeps it: goals of both, seconds of play, who it was against."""

    goals: tuple[int, int]
    seconds: float
    opponent: str


def read_circle(folder: Path) -> dict[str, Any]:
    """The result of a circle in its folder. ValueError, in one line, if there is none."""
    from sim2real.gap.result import FORMAT as CIRCLE

    path = folder / "gap.json"
    try:
        content = json.loads(path.read_text(encoding="utf-8"))
    except OSError:
        raise ValueError(f"{folder} has no gap.json: expected the --out of a puckpilot gap that is done") from None
    except ValueError:
        content = {}
    if not isinstance(content, dict) or content.get("format") != CIRCLE:
        raise ValueError(f"{path} is no result of puckpilot gap: expected the format {CIRCLE}")
    return content


def overview(circles: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """The result of all `circles`. ValueError, in one line, if they cannot be compared."""
    for name in ALIKE:
        values = sorted({_in_words(one["conditions"][name]) for one in circles})
        if len(values) > 1:
            raise ValueError(f"circles of different {name} cannot be compared: {', '.join(values)}")
    for one in circles:
        if one["conditions"]["backend"] != TWIN:
            raise ValueError(f"a circle of {one['conditions']['table']} has no truth to be held against; leave it out")
        find_table(one["conditions"]["table"])
    concealed = [one for one in circles if one["conditions"]["table"] != CONTROL]
    seen = {one["conditions"]["table"] for one in circles}
    for one, other in combinations(circles, 2):
        _refuse_same_games(one["conditions"], other["conditions"])
    tables = {
        table: _of_table([one for one in circles if one["conditions"]["table"] == table])
        for table in TABLES
        if table in seen
    }
    return {
        "format": FORMAT,
        "conditions": {name: circles[0]["conditions"][name] for name in ALIKE},
        "tables": tables,
        "all": _of_arms(concealed) if concealed else {},
        "own_better_on": _own_better_on([one["arms"] for name, one in tables.items() if name != CONTROL]),
    }


def _own_better_on(tables: Sequence[Mapping[str, Any]]) -> dict[str, dict[str, int]]:
    """By the name of each other arm: of how many `tables`, which have both, the arm OWN is `better` than it, `clearly`
    so, beyond the interval; and better `in_simulator`, of those `simulated`, of which that has anything."""
    counts = {}
    for arm in ARMS:
        both = [(one[OWN], one[arm]) for one in tables if OWN in one and arm in one and arm != OWN]
        simulated = [(own["simulated"], other["simulated"]) for own, other in both if own["simulated"] is not None]
        if both:
            counts[arm] = {
                "tables": len(both),
                "better": sum(other["own_better_by"]["value"] > 0.0 for _, other in both),
                "clearly": sum(other["own_better_by"]["low"] > 0.0 for _, other in both),
                "simulated": len(simulated),
                "in_simulator": sum(own > other for own, other in simulated),
            }
    return counts


def _in_words(condition: Any) -> str:
    return " ".join(condition) if isinstance(condition, list) else str(condition)


def _refuse_same_games(one: Mapping[str, Any], other: Mapping[str, Any]) -> None:
    """ValueError, in one line, if two circles share games: the n-th game of a circle is of its seed plus n."""
    first, second = sorted((one, other), key=lambda each: each["seed"])
    if one["table"] == other["table"] and second["seed"] < first["seed"] + first["games"]:
        raise ValueError(
            f"circles of the table {one['table']} with the seeds {first['seed']} and {second['seed']} share games: "
            f"{first['games']} games need seeds as far from each other"
        )


def _of_table(circles: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    simulated = [one["simulator"]["scored"] - one["simulator"]["conceded"] for one in circles]
    before = [one["before"]["net"]["value"] for one in circles]
    if any(one["arms"].keys() != circles[0]["arms"].keys() for one in circles):
        raise ValueError(f"circles of the table {circles[0]['conditions']['table']} have different arms")
    return {
        "seeds": [one["conditions"]["seed"] for one in circles],
        "simulator": sum(simulated) / len(circles),
        "before": sum(before) / len(circles),
        "found": [sorted(one["found"]) for one in circles],
        "arms": _of_arms(circles),
    }


def _of_arms(circles: Sequence[Mapping[str, Any]]) -> dict[str, Any]:
    """By the name of each arm that all these circles have, see `_of_arm`."""
    arms = [arm for arm in ARMS if all(arm in one["arms"] for one in circles)]
    return {arm: _of_arm(circles, arm, arms) for arm in arms}


def _of_arm(circles: Sequence[Mapping[str, Any]], arm: str, arms: Sequence[str]) -> dict[str, Any]:
    """What an arm won back, over all circles and of each; the same in the simulator with what is concealed, over those
    of which that has anything, None if there are none; that on the tables as a share of the ceiling's; and by how much
    the arm OWN is better than it."""
    gains = [_net(one, arm) - _net(one, BEFORE) for one in circles if TRUTH in one["in_simulator"][BEFORE]]
    before, after = [_games(one["before"]) for one in circles], [_games(one["arms"][arm]) for one in circles]
    series = list(zip(before, after, strict=True))
    content: dict[str, Any] = {
        "change": asdict(mean_change(series)),
        "of_seeds": [mean_change([one]).value for one in series],
        "simulated": sum(gains) / len(gains) if gains else None,
    }
    if CEILING in arms and arm != CEILING:
        best = [_games(one["arms"][CEILING]) for one in circles]
        of_ceiling = share(list(zip(before, after, best, strict=True)))
        content["share"] = asdict(of_ceiling) if of_ceiling else None
    if OWN in arms and arm != OWN:
        own = [_games(one["arms"][OWN]) for one in circles]
        content["own_better_by"] = asdict(mean_change(list(zip(after, own, strict=True))))
    return content


def _net(circle: Mapping[str, Any], name: str) -> float:
    rates = circle["in_simulator"][name][TRUTH]
    return rates["scored"] - rates["conceded"]


def _games(played: Mapping[str, Any]) -> list[PlayedGame]:
    return [PlayedGame((scored, conceded), *others) for scored, conceded, *others in played["games"]]
