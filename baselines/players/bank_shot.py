"""Strikes like the interceptor, but off the side walls."""

from __future__ import annotations

from baselines.planning.aim import BANK_LEFT, BANK_RIGHT
from baselines.planning.attack import Attacker


class BankShot(Attacker):
    """Aims at the middle of the goal off the wall that allows the earlier strike."""

    shots = ((BANK_RIGHT, 0.0), (BANK_LEFT, 0.0))
