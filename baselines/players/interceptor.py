"""Predicts the puck, walls included, meets it in time and strikes straight at the opponent's goal."""

from __future__ import annotations

from baselines.aim import DIRECT
from baselines.attack import Attacker


class Interceptor(Attacker):
    """Aims at the middle of the goal."""

    ways = ((DIRECT, 0.0),)
