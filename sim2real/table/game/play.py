"""Games of a player at the robot's seat of a table, one or as many as a time takes."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from baselines.player import Player, Seat
from sim2real.table.faults import TableFaultError
from sim2real.table.game.game_log import GameLog
from sim2real.table.game.loop import Loop
from sim2real.table.game.robot_seat import RobotSeat
from sim2real.table.game.seated_player import seated_player

ROUNDING = 1e-6  # s; less is no time to play
Show = Callable[[Loop, NDArray[np.float32], dict[str, Any]], None]


def play_game(
    env: RobotSeat,
    player: str,
    seed: int,
    seconds: float | None,
    report: Callable[[str], None],
    may_clear: Callable[[TableFaultError], bool],
    show: Show,
) -> GameLog:
    """Play a game, at most `seconds` of it, and return what came of it. A whole game ends with the mallet at home; one
    that is cut off ends with the mallet on its way, until `env` is closed.

    report: takes a line for each goal, foul and fault; may_clear: whether to go on after a fault, when it is mended;
    show: takes loop, action and info of each step.
    ValueError, in one line, for an unknown name, and for a policy of another game or rate.
    """
    return _play(env, _seated(env, player, seed), seed, seconds, report, may_clear, show)


def play_for(
    env: RobotSeat,
    player: str,
    seed: int,
    seconds: float,
    report: Callable[[str], None],
    may_clear: Callable[[TableFaultError], bool],
    show: Show,
) -> GameLog:
    """Play so many `seconds`, a new game where one ends, and return what came of all together; see `play_game`."""
    actor = _seated(env, player, seed)
    log = _play(env, actor, seed, seconds, report, may_clear, show)
    while seconds - log.seconds > ROUNDING and not log.interrupted and log.fault is None:
        log = log.with_next(_play(env, actor, None, seconds - log.seconds, report, may_clear, show))
    return log


def _seated(env: RobotSeat, player: str, seed: int) -> Player:
    actor = seated_player(player, Seat.from_tables(env.tables, 2 * seed))
    actor.act(np.zeros((1, *(env.observation_space.shape or ())), np.float32))  # compiled before the motors are armed
    return actor


def _play(
    env: RobotSeat,
    actor: Player,
    seed: int | None,
    seconds: float | None,
    report: Callable[[str], None],
    may_clear: Callable[[TableFaultError], bool],
    show: Show,
) -> GameLog:
    """A game, the first of its seed, or one more of the same table."""
    actor.reset(np.ones(1, bool))
    log, over = GameLog(), False
    try:
        observation, info = env.reset(seed=seed)
    except TableFaultError as fault:
        log.faults.append(str(fault.cause))
        observation, info = _cleared(env, fault, may_clear)
    begin, began = info["time"], time.perf_counter()
    try:
        while not over and (seconds is None or seconds - log.seconds > ROUNDING):
            try:
                action = actor.act(observation[None])[0]
                observation, _, terminated, truncated, info = env.step(action)
                over = terminated or truncated
                if env.loop is not None:
                    log.times, log.shots = env.loop.times, env.loop.referee.shots.counts
                    show(env.loop, action, info)
                _note(log, info, report)
            except TableFaultError as fault:
                report(f"{log.seconds:6.1f} s  stopped, {fault.cause}: {fault}")
                log.faults.append(str(fault.cause))
                observation, info = _cleared(env, fault, may_clear)
            if info["new_point"]:
                actor.reset(np.ones(1, bool))
    except KeyboardInterrupt as stop:
        if stop.args:  # another signal, which ends the program
            raise
        env.close()
        log.interrupted = True
    except TableFaultError as fault:
        log.fault = fault
    log.table_seconds, log.wall_seconds = info["time"] - begin, time.perf_counter() - began
    log.outcome = int(info.get("outcome", np.sign(log.score[0] - log.score[1])))
    return log


def _cleared(
    env: RobotSeat, fault: TableFaultError, may_clear: Callable[[TableFaultError], bool]
) -> tuple[np.ndarray, dict[str, Any]]:
    """The observation and info with which play goes on; raises the fault where it does not."""
    while may_clear(fault):
        try:
            return env.clear()
        except TableFaultError as still:
            fault = still
    raise fault


def _note(log: GameLog, info: dict[str, Any], report: Callable[[str], None]) -> None:
    """Add a step to the log, and report goals, fouls and face-offs."""
    score, fouls = ((int(info[name][0]), int(info[name][1])) for name in ("score", "fouls"))
    for name, before, after in (("goal", log.score, score), ("foul", log.fouls, fouls)):
        for who, was, is_now in zip(("robot", "opponent"), before, after, strict=True):
            if is_now > was:
                report(f"{info['play_time']:6.1f} s  {name} of the {who}, {score[0]}:{score[1]}")
    if info["new_point"]:
        report(f"{info['play_time']:6.1f} s  face-off")
    log.score, log.fouls, log.seconds = score, fouls, info["play_time"]
    log.plans, log.parked = info["plans"], info["parked"]
    log.off_path = max(log.off_path, info["off_path"])
