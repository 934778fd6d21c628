"""Predicts the puck, walls included, intercepts it and strikes straight at the opponent's goal."""

from __future__ import annotations

from baselines.planning.aim import DIRECT
from baselines.planning.attack import Attacker


class Interceptor(Attacker):
    """Aims at the middle of the goal."""

    shots = ((DIRECT, 0.0),)
