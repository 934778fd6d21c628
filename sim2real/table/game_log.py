"""What came of a game at a table."""

from __future__ import annotations

from dataclasses import dataclass, field


@dataclass
class GameLog:
    """score, fouls: of the robot and its opponent; outcome: 1 won, 0 nobody, -1 lost; seconds: of play.

    plans: sent to the board; frame_ages [s]: of the newest frame at each decision; off_path [m]: the farthest that the
    encoders had the mallet from its path.
    """

    score: tuple[int, int] = (0, 0)
    fouls: tuple[int, int] = (0, 0)
    outcome: int = 0
    seconds: float = 0.0
    plans: int = 0
    frame_ages: list[float] = field(default_factory=list)
    off_path: float = 0.0
