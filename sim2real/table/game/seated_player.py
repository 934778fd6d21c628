"""A player for a seat at a table: not one that was trained for another game, or for decisions at another rate."""

from __future__ import annotations

from baselines import find_player
from baselines.player import Player, Seat
from puckpilot_env.variants import find_variant


def seated_player(name: str, seat: Seat) -> Player:
    """The player of this name. ValueError, in one line, for an unknown name, or a policy of another game or rate."""
    player = find_player(name)(seat)
    if not player.made_for:
        return player
    trained, here = find_variant(player.made_for), find_variant(seat.variant)
    if trained.game != here.game or trained.period != seat.period:
        periods = (trained.period, seat.period)
        rates = [f", a decision every {one:g} s" if trained.game == here.game else "" for one in periods]
        raise ValueError(
            f"{name} was trained for {trained.id}{rates[0]}; here {here.id} is played{rates[1]}; choose a player of "
            "that game, or a script"
        )
    return player
