"""The result of a circle, of what its stages left in its folder."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import Any

from sim2real.gap.against_truth import against_truth, learnt
from sim2real.gap.circle_folder import BEFORE, FILM, CircleFolder, missing
from sim2real.gap.in_simulator import UNCHANGED, simulated_rates
from sim2real.table.meetings import Meeting, PlayedMeeting, kept_games
from sim2real.table.score import change, score, shots

FORMAT = "puckpilot-gap/7"


def result(folder: CircleFolder, arms: list[str]) -> dict[str, Any]:
    """What gap.json holds. ValueError, in one line, if a stage has to be run first.

    Rates are goals a minute, over opponents the mean; `simulator`: of the player as it is, on tables without an effect;
    `in_simulator`: of each player there and with what is concealed, see `in_simulator.simulated_rates`. `films`: paths
    from the folder, of the player as it is under "before" and of each arm; `against_truth`: see there, None where no
    truth is known; `learnt`: see there;
    `open`: why the diagnosis says nothing of a regime, by its name, and under "all" why it says nothing at all.
    """
    if not folder.simulated(BEFORE).exists():
        raise missing(folder.simulated(BEFORE).parent, "games", "play")
    before = _kept(folder.meetings_before(), folder.before, "play")
    content = folder.diagnosed()
    after = {arm: _kept(folder.meetings_after(arm), folder.path / arm / "games", "replay") for arm in arms}
    table = folder.conditions.gap_table
    simulated = {name: simulated_rates(folder.simulated(name)) for name in (BEFORE, *arms)}
    return {
        "format": FORMAT,
        "conditions": asdict(folder.conditions),
        "simulator": simulated[BEFORE][UNCHANGED],
        "in_simulator": simulated,
        "before": _played(before),
        "found": [one["mechanism"] for one in content["findings"]],
        "verdict": content["verdict"],
        "open": _open(content),
        "against_truth": against_truth(content["findings"], table.concealed) if table.concealed else None,
        "learnt": learnt(folder.path, table),
        "arms": {arm: {**_played(games), "change": asdict(change(before, games))} for arm, games in after.items()},
        "films": {name: f"{name}/{FILM}" for name in (BEFORE, *arms) if (folder.path / name / FILM).exists()},
    }


def _kept(meetings: list[Meeting], folder: Path, stage: str) -> list[PlayedMeeting]:
    games = kept_games(meetings, folder)
    if len(games) < len(meetings):
        raise missing(folder, f"{len(meetings)} games", stage)
    return games


def _open(diagnosis: dict[str, Any]) -> dict[str, str]:
    reasons = {one["regime"]: one["reason"] for one in diagnosis["regimes"] if one.get("reason")}
    return reasons | ({"all": diagnosis["reason"]} if diagnosis.get("reason") else {})


def _played(games: list[PlayedMeeting]) -> dict[str, Any]:
    """What came of a player's games: rates a minute, also against each opponent alone, shots, stops of the table, and
    goals, seconds and opponent of each game."""
    return {
        **{name: asdict(rate) for name, rate in score(games).items()},
        "against": {
            one: {name: asdict(rate) for name, rate in score([game for game in games if game.opponent == one]).items()}
            for one in dict.fromkeys(game.opponent for game in games)
        },
        "shots": asdict(shots(games)),
        "stops": sum(game.stops for game in games),
        "games": [[*game.goals, game.seconds, game.opponent] for game in games],
    }
