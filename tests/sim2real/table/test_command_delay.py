"""Motors that obey late, which a board that knows of it allows for: by the independent physics of the twin."""

from __future__ import annotations

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from puckpilot_env.variants import find_variant
from sim2real.table.board_config import MOST_COMMAND_DELAY
from sim2real.table.game.game_record import GameRecord
from sim2real.table.game.loop import home_of
from sim2real.table.mallet_driver import AHEAD, MalletDriver
from sim2real.table.twin.twin import Twin, law_of

LATE = 0.005  # s
STROKES = ((0.15, 0.25), (0.45, 0.75), (0.2, 0.7), (0.4, 0.3), (0.3, 0.5))  # m, from which a new one begins in motion


def errors(command_delay: float | None) -> np.ndarray:
    """How far the mallet is from where its plans have it [m], in strokes on a table whose motors obey LATE."""
    game = GameRecord(find_variant("match-v0"))
    law = replace(law_of(game.p), command_delay=LATE)
    with closing(Twin(game, law=law, command_delay=command_delay)) as table:
        home = home_of(game.p)
        table.connect(home)
        driver, found = MalletDriver(game.p), []
        driver.stand(*home, table.now())
        for x, y in STROKES:
            table.send(driver.plan([x, y, 14.0, 14.0], table.now() + table.ahead))
            for _ in range(40):
                table.wait(table.now() + 0.003)
                found.append(np.subtract(table.plant.mallet(0)[:2], driver.motion(table.now())[:2]))
        assert not table.read().missed
    return np.linalg.norm(found, axis=1)


@pytest.mark.slow
def test_the_mallet_is_where_its_plans_have_it():
    assert errors(LATE).max() < 1.5e-3
    assert errors(None).max() > 4e-3


def test_plans_are_made_so_much_earlier():
    table = Twin(GameRecord(find_variant("match-v0")), command_delay=LATE)
    assert table.ahead == pytest.approx(AHEAD + LATE) and table.config.command_delay == 5000


@pytest.mark.parametrize("late", [-0.001, 2 * MOST_COMMAND_DELAY])
def test_a_delay_that_no_board_allows_for_is_refused(late: float):
    with pytest.raises(ValueError, match=rf"^command_delay is {late:g} s; expected 0 to 0.01$"):
        Twin(GameRecord(find_variant("match-v0")), command_delay=late)
