"""One game of a player at the robot's seat of a table."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from baselines import find_player
from baselines.player import Seat
from puckpilot_env.variants import Variant
from sim2real.table.game_log import GameLog
from sim2real.table.robot_seat import make_robot_seat


def play(
    player: str,
    backend: str,
    opponent: str,
    variant: Variant,
    seed: int,
    seconds: float | None,
    report: Callable[[str], None],
) -> GameLog:
    """Play a game, at most `seconds` of it, and return what came of it. `report` takes a line for each goal and foul.

    ValueError, in one line, for an unknown name, and where the table stopped.
    """
    make = find_player(player)
    env = make_robot_seat(variant, backend, opponent, seed=seed)
    try:
        actor = make(Seat.from_tables(env.tables, 2 * seed))
        observation, info = env.reset(seed=seed)
        log, over = GameLog(), False
        while not over and (seconds is None or log.seconds < seconds):
            log.frame_ages.append(info["frame_age"])
            observation, _, terminated, truncated, info = env.step(actor.act(observation[None])[0])
            over = terminated or truncated
            _note(log, info, report)
            if info["new_point"]:
                actor.reset(np.ones(1, bool))
        log.outcome = int(info.get("outcome", np.sign(log.score[0] - log.score[1])))
        return log
    finally:
        env.close()


def _note(log: GameLog, info: dict[str, Any], report: Callable[[str], None]) -> None:
    """Add a step to the log, and report goals and fouls."""
    score, fouls = ((int(info[name][0]), int(info[name][1])) for name in ("score", "fouls"))
    for name, before, after in (("goal", log.score, score), ("foul", log.fouls, fouls)):
        for who, was, is_now in zip(("robot", "opponent"), before, after, strict=True):
            if is_now > was:
                report(f"{info['play_time']:6.1f} s  {name} of the {who}, {score[0]}:{score[1]}")
    log.score, log.fouls, log.seconds = score, fouls, info["play_time"]
    log.plans = info["plans"]
    log.off_path = max(log.off_path, info["off_path"])
