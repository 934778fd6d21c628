"""A mallet in a hand: effects of mallet and gantry, and the limit of plans, do not hinder it.

With the parameter `hand` player 1 has one, so that what the robot's side of a table costs a player is not taken from
its opponent as well.
"""

from __future__ import annotations

from puckpilot_env.kernel import kernel


@kernel
def is_by_hand(puck, p, k):
    """Whether player `k` has its mallet in a hand; on a table that was turned round player 1 sits in seat 0."""
    return p.hand != 0.0 and k != puck.turned
