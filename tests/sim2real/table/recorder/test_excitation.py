"""The gantry's excitation: every voltage and choice of axes in each round, inside the area, the same for a seed."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pytest

from puckpilot_env.game import mirror
from sim2real.table.game.game_record import GameRecord
from sim2real.table.recorder.excitation import MARGIN, SHORTEST, VOLTS, excitation, refuse_volts

START = (0.25, 0.5)


@pytest.fixture(scope="module")
def p() -> np.void:
    return GameRecord("puckpilot/match-v0").p


def test_a_round_has_every_voltage_with_every_choice_of_axes(p: np.void) -> None:
    moves = list(islice(excitation(p, START, VOLTS, 1), 24))
    places = np.array([START, *(one.place for one in moves)])
    went = np.abs(np.diff(places, axis=0))
    for first in (0, 12):
        rows = [(*(went[k] > 0.0), moves[k].volts) for k in range(first, first + 12)]
        alone = [(x, volts) for x, y, volts in rows if x != y]
        assert sorted(alone) == sorted((x, (one, one)) for one in VOLTS for x in (True, False))
        assert sum(x and y for x, y, _ in rows) == len(VOLTS)
    assert went[went > 0.0].min() >= SHORTEST
    x_low, x_high, y_low, y_high = mirror.area(0, p)
    assert np.all(places[1:] >= np.array([x_low, y_low]) + MARGIN - 1e-12)
    assert np.all(places[1:] <= np.array([x_high, y_high]) - MARGIN + 1e-12)


def test_a_seed_gives_the_same_moves(p: np.void) -> None:
    once, again, other = (list(islice(excitation(p, START, VOLTS, seed), 30)) for seed in (1, 1, 2))
    assert once == again != other


@pytest.mark.parametrize("volts", [0.0, 14.5, float("nan")])
def test_a_voltage_that_no_motor_may_get_is_refused(p: np.void, volts: float) -> None:
    with pytest.raises(ValueError, match="expected more than 0, at most 14 V"):
        refuse_volts(p, [4.0, volts])
