"""A live view of a game for a terminal: what is seen, planned and late."""

from __future__ import annotations

from typing import Any

import numpy as np

from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import Loop

COLUMNS, ROWS = 64, 20
PUCK, EXPECTED, ROBOT, TARGET, OPPONENT = "o", "·", "R", "x", "P"


def picture(loop: Loop, target: tuple[float, float], info: dict[str, Any]) -> list[str]:
    """Lines of text: the table from above, with the puck as seen last and as expected when the next action acts, both
    mallets and the `target` [m] of the robot's plan; below it score, ages and faults, of the `info` of a step."""
    game, now = loop.game, info["acts_at"]
    board = np.full((ROWS, COLUMNS), " ")
    expected, seen = loop.seen.puck_at(now), loop.seen.puck.motion()
    robot, opponent = loop.motion(now), loop.seen.opponent_at(now)
    for mark, place in ((TARGET, target), (EXPECTED, expected), (PUCK, seen), (OPPONENT, opponent), (ROBOT, robot)):
        if place is not None:
            _put(board, mark, place[0], place[1], game)
    edge = "+" + "-" * COLUMNS + "+"
    scored, conceded = info["score"]
    late = loop.times.lateness[-1] if loop.times.lateness else 0.0
    return [
        edge, *("|" + "".join(row) + "|" for row in board), edge,
        f"{info['play_time']:6.1f} s   robot {scored}:{conceded} opponent   parked {info['parked']:.1f} s",
        f"frame {1e3 * info['frame_age']:5.1f} ms old   decision {1e3 * late:5.1f} ms late   "
        f"off path {1e3 * info['off_path']:4.1f} mm",
        f"{PUCK} puck  {EXPECTED} when the action acts  {ROBOT} robot  {TARGET} its target  {OPPONENT} opponent",
    ]  # fmt: skip


def _put(board: np.ndarray, mark: str, x: float, y: float, game: GameRecord) -> None:
    """Put a mark at a place [m]; x goes to the right, y upwards."""
    column = round(x / float(game.p["length"]) * (COLUMNS - 1))
    row = round((1.0 - y / float(game.p["width"])) * (ROWS - 1))
    if 0 <= column < COLUMNS and 0 <= row < ROWS:
        board[row, column] = mark
