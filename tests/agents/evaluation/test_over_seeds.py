"""The interquartile mean over runs: computed by hand, and the coverage of its interval."""

from __future__ import annotations

import numpy as np
import pytest

from agents.evaluation.over_seeds import iqm, iqm_estimate, rows_over_seeds


def test_iqm_is_the_mean_of_the_middle_half() -> None:
    assert iqm([[0.0], [0.5], [0.6], [1.0]]) == pytest.approx(0.55)
    assert iqm([[0.1, 0.2, 0.3, 0.4], [0.5, 0.6, 0.7, 100.0]]) == pytest.approx((0.3 + 0.4 + 0.5 + 0.6) / 4)
    assert iqm([[0.0], [0.4], [0.5], [0.6], [9.0]]) == pytest.approx(0.5)  # one of five is cut on either side


def test_one_lucky_seed_moves_it_little() -> None:
    plain, lucky = [[0.5], [0.5], [0.5], [0.5], [0.5]], [[0.5], [0.5], [0.5], [0.5], [1.0]]
    assert iqm_estimate(plain).as_dict() == {"value": 0.5, "low": 0.5, "high": 0.5}
    assert iqm(lucky) == 0.5 and iqm_estimate(lucky).high > 0.5


@pytest.mark.slow
def test_the_interval_has_about_the_right_coverage() -> None:
    """Ten runs on eight tasks; the truth is the IQM of very many runs."""
    rng = np.random.default_rng(3)
    levels = rng.uniform(0.2, 0.9, 8)
    truth = iqm(levels + 0.1 * rng.normal(size=(100_000, 8)))
    covered = 0
    for k in range(300):
        found = iqm_estimate(levels + 0.1 * rng.normal(size=(10, 8)), k)
        covered += found.low <= truth <= found.high
    assert covered >= 0.92 * 300


@pytest.mark.slow
@pytest.mark.parametrize("separately", [False, True])
def test_intervals_of_five_runs_hold_the_truth(separately: bool) -> None:
    """400 draws of five policies against three opponents, whose scores go together; or of three tasks, each with five
    policies of its own."""
    rng, held = np.random.default_rng(3), 0
    for _ in range(400):
        scores = rng.uniform(0.2, 0.8, (5, 3 if separately else 1)) + np.zeros((5, 3))
        found = iqm_estimate(scores, separately=separately)
        held += found.low <= 0.5 <= found.high
    assert held >= 0.92 * 400


def test_a_single_run_says_nothing_of_others() -> None:
    assert iqm_estimate([[0.2, 0.4]]).as_dict() == {"value": pytest.approx(0.3), "low": 0.0, "high": 1.0}


def _row(opponent: str, share: float | None, job: float | None = None) -> dict:
    return {
        "variant": "puckpilot/match-v0", "opponent": opponent, "decisive_win_rate": {"value": share},
        "role": None if job is None else {"job": "clear", "endings": {"clear": {"value": job}}},
    }  # fmt: skip


def test_rows_hold_shares_and_iqm_and_a_last_one_is_of_all_matchups() -> None:
    rows_of_each = {
        "a": [_row("still", 1.0), _row("goalie", None), _row("veteran", 0.1, 0.8)],
        "b": [_row("still", 0.5), _row("goalie", 0.3), _row("veteran", 0.9, 0.6)],
    }
    still, goalie, veteran, whole = rows_over_seeds(rows_of_each, 0)
    assert still["shares"] == [1.0, 0.5] and still["iqm"]["value"] == pytest.approx(0.75)
    assert goalie["shares"] == [None, 0.3] and goalie["iqm"] is None
    assert veteran["shares"] == [0.8, 0.6]  # a drill's share is that of its job
    assert (whole["variant"], whole["opponent"]) == ("all", "2 of 3 that have a share")
    assert whole["shares"] == pytest.approx([0.9, 0.55]) and whole["iqm"]["value"] == pytest.approx(0.7)
    assert len(rows_over_seeds({"a": rows_of_each["a"][:1]}, 0)) == 1
