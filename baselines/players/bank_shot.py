"""Strikes like the interceptor, but over the side walls."""

from __future__ import annotations

from baselines.aim import OVER_LEFT, OVER_RIGHT
from baselines.attack import Attacker


class BankShot(Attacker):
    """Aims at the middle of the goal over whichever wall it can use sooner."""

    ways = ((OVER_RIGHT, 0.0), (OVER_LEFT, 0.0))
