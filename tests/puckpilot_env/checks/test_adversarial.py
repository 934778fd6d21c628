"""No table breaks a law at the ends of its ranges; and what would break one is seen, told, and can be seen again."""

from __future__ import annotations

import argparse
import time

import numpy as np
import pytest

from puckpilot_env import Tables
from puckpilot_env.checks.adversarial import extremes, invariants, play, worker
from puckpilot_env.checks.adversarial.play import STEPS, TABLES, Found, Place, Slowest, play_batch
from puckpilot_env.commands import check
from puckpilot_env.parameters import BY_NAME, check_together
from puckpilot_env.variants import all_variants

ONE = "puckpilot/match-v0"


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(len(all_variants())))
def test_nothing_breaks(seed):
    found = play_batch(list(all_variants())[seed], seed)
    assert [str(breach) for breach in found.breaches] == []
    assert found.steps == TABLES * STEPS == found.times.sum()


def test_an_elastic_puck_between_both_mallets_on_the_middle_line_is_in_neither():
    """Both close in on it for half a second; it goes to and fro over the line ever faster, hundreds of times."""
    elastic = {"mallet_restitution": 1.0, "wall_restitution": 1.0, "friction": 0.0, "drag": 0.0}
    tables = Tables("match-v0", 9, parameters=elastic, period=1.0)
    puck, mallets = tables.states["puck"], tables.states["mallets"]
    apart = float(tables.params["mallet_radius"][0] + tables.params["puck_radius"][0])
    for k, side in enumerate((-1.0, 1.0)):
        mallets["x"]["rest"][:, k], mallets["y"]["rest"][:, k] = 1.0 + side * 0.0506, 0.3
    puck["x"], puck["y"], puck["vx"], puck["vy"] = 1.0, 0.3 + apart + 0.3, 0.0, 0.0
    puck["vx"] = np.linspace(0.1, 8.0, 9)
    puck["y"] = 0.3 + np.sqrt(apart**2 - 0.0506**2) + 0.05
    for target in (0.9, 0.9495):
        actions = np.zeros((9, 2, 4), np.float32)
        actions[:] = (0.9494, target, 10.0, 10.0)
        actions[:, 1, 1] = 1.0 - target
        tables.step(np.clip(actions, *tables.action_bounds))
        assert invariants.depth_in_mallets(tables).max() <= 1e-7
        assert invariants.depth_outside(tables).max() <= 1e-9


@pytest.mark.slow
def test_tables_are_drawn_over_their_whole_ranges():
    """Ends and what is between them, of nearly every number that a table can have; every table is one."""
    low, high, between = set(), set(), set()
    for seed in range(10):
        tables, _ = extremes.draw_tables(ONE, TABLES, seed)
        for record in tables.params:
            check_together(record)
        for name, row in BY_NAME.items():
            values = tables.params[name]
            low |= {name} if (values == row.low).any() and row.low != row.default else set()
            high |= {name} if (values == row.high).any() and row.high != row.default else set()
            between |= {name} if ((values > row.low) & (values < row.high) & (values != row.default)).any() else set()
    simulated = {row for name in extremes.SIMULATED for row in extremes.EFFECTS[name].row_names}
    listed = {row for row in simulated if not row.startswith(("unlisted_", "bounce_", "blow_", "window_", "drive_"))}
    assert simulated <= between | {"blow_kind", "blow_share"}
    assert {name for name in listed if BY_NAME[name].low != BY_NAME[name].default} <= low
    assert {name for name in listed if BY_NAME[name].high != BY_NAME[name].default} <= high


@pytest.mark.parametrize(
    "field, value, expected",
    [
        ("x", np.nan, "a number is not finite"),
        ("y", 0.03, "the puck is outside, by [m] 0.0009"),
        ("x", 0.25, "the puck is inside a mallet, by [m]"),
        ("vx", 1e4, "the puck is too fast [m/s] 1e+04"),
        ("vx", 3.0, "energy from nowhere, a speed of [m/s] too much"),
        ("spin", 200.0, "energy from nowhere, a speed of [m/s] too much"),
    ],
)
def test_broken_laws_are_told(field, value, expected):
    tables = Tables("defence-v0", 2, seed=1)
    puck = tables.states["puck"]
    puck["x"], puck["y"], puck["vx"], puck["vy"] = 0.6, 0.5, 0.5, 0.0
    before = invariants.Before(tables)
    tables.states["held"] += tables.variant.period
    assert not any(where.any() for where, _, _ in invariants.broken(tables, before))
    puck[field][1] = value
    found = [f"{what} {amount[1]:.3g}" for where, what, amount in invariants.broken(tables, before) if where[1]]
    assert found and found[0].startswith(expected)
    assert not any(where[0] for where, _, _ in invariants.broken(tables, before))


def test_a_mallet_out_of_its_area_is_told():
    tables = Tables(ONE, 3, seed=1)
    before = invariants.Before(tables)
    tables.states["mallets"]["x"]["rest"][1, 0] = 0.5 * tables.params["length"][1] - tables.params["mallet_radius"][1]
    tables.states["mallets"]["y"]["rest"][2, 1] = tables.params["mallet_radius"][1] - 1e-3
    (found,) = [(where, amount) for where, what, amount in invariants.broken(tables, before) if "area" in what]
    assert found[0].tolist() == [False, False, True]
    assert found[1][2] == pytest.approx(1e-3)


def test_what_breaks_names_table_and_step_and_leaves_the_game(monkeypatch):
    def faulty(tables, before):
        return [(tables.states["steps"] == 5, "five", np.full(len(tables), np.nan))]

    monkeypatch.setattr(invariants, "broken", faulty)
    found = play_batch(ONE, 3)
    assert len(found.breaches) == TABLES
    assert {breach.place.step for breach in found.breaches} == {4}
    assert found.steps == TABLES * 5
    command = "table 0, step 4 of puckpilot check --adversarial 1 --seed 3 puckpilot/match-v0\n  period"
    assert str(found.breaches[0]).startswith(f"five: {command}")


def test_a_batch_is_the_same_each_time():
    ends = []
    for _ in range(2):
        notes = []
        play_batch(ONE, 7, lambda step, table, notes=notes: notes.append((step, table)))
        tables, rng = extremes.draw_tables(ONE, TABLES, 7)
        ends.append((notes, tables.states.tobytes(), rng.random()))
    assert ends[0] == ends[1]
    assert ends[0][0] == [(step, table) for step in range(STEPS) for table in range(TABLES)]


def never_ends(name, seed, note):
    """A batch whose step 2 of table 3 does not end where its seed is odd."""
    if seed % 2:
        note(2, 3)
        time.sleep(60.0)
    return Found(steps=1)


def work(tasks, place, right=worker._work):
    """`worker._work`, in a process of its own, on batches of `never_ends`."""
    worker.play_batch = never_ends
    right(tasks, place)


@pytest.mark.slow
def test_a_step_that_does_not_end_is_told_and_the_next_batch_played(monkeypatch):
    monkeypatch.setattr(worker, "_work", work)
    own = worker.Worker(0.5)
    try:
        assert own.play(ONE, 0).steps == 1
        (breach,) = own.play(ONE, 1).breaches
        assert str(breach).startswith("a step does not end within 0.5 s: table 3, step 2 of puckpilot check")
        assert own.play(ONE, 2).steps == 1
    finally:
        own.end()


@pytest.mark.parametrize("slowest, broke, code", [(0.98, False, 0), (1.04, False, 1), (0.1, True, 1)])
def test_the_command_fails_where_something_broke_or_took_long(monkeypatch, capsys, slowest, broke, code):
    def play_many(names, steps, seed, show):
        place = Place(names[0], seed, 1, 2, "period 0.1 s")
        breaches = [play.Breach("it broke", place)] if broke else []
        most = play.MOST_MEDIANS * 1e-5
        found = Found(steps, breaches, slowest=Slowest(slowest * most, place))
        found.times[int(play.BINS_OF_DOUBLE * np.log2(1e4))] = steps
        show(found)
        return found

    monkeypatch.setattr(worker, "play_many", play_many)
    parser = argparse.ArgumentParser()
    check.add_arguments(parser)
    assert check.run(parser.parse_args(["--adversarial", "2000", "--seed", "4", "match-v0"])) == code
    expected = capsys.readouterr().out
    assert (
        "it broke: table 1, step 2 of puckpilot check --adversarial 1 --seed 4 puckpilot/match-v0" in expected
    ) == broke
    assert f"2,000 steps, {int(broke)} broke a rule" in expected
    assert ("failed: the slowest step takes too long\n" in expected) == (slowest > 1.0)


def test_the_command_refuses_no_steps():
    parser = argparse.ArgumentParser()
    check.add_arguments(parser)
    with pytest.raises(ValueError, match="--adversarial is 0; expected"):
        check.run(parser.parse_args(["--adversarial", "0"]))
