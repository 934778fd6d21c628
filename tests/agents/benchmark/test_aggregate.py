"""What several seeds say, by hand-made outcomes."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from agents.benchmark import aggregate
from agents.benchmark.protocol import read_protocol
from agents.benchmark.report import page_of, summary, write_report
from agents.benchmark.training import FORMAT

PROTOCOL = read_protocol()


def outcome(algorithm: str, task: str, seed: int, scores: list[float], reached: int = 0) -> dict[str, Any]:
    """An outcome whose curve is 0.8 against the first opponent from its point `reached` on, 0 for never."""
    opponents = PROTOCOL.evaluated_against(PROTOCOL.tasks[task])
    rows = [{"opponent": one, "score": score} for one, score in zip(opponents, scores, strict=True)]
    curve = [
        {"steps": 100 * k, "seconds": 1.5 * k, "scores": {opponents[0]: 0.8 if reached and k >= reached else 0.1}}
        for k in (1, 2, 3)
    ]
    return {
        "format": FORMAT, "protocol": PROTOCOL.hash, "algorithm": algorithm, "task": task, "seed": seed, "budget": 300,
        "library": "none", "version": "0", "steps": 300, "seconds": 4.5, "curve": curve, "evaluation": rows,
    }  # fmt: skip


RUNS = [
    outcome("a", "match-v0", 0, [0.9, 0.5, 0.1, 0.2], 1),
    outcome("a", "match-v0", 1, [0.9, 0.6, 0.0, 0.4], 3),
    outcome("a", "attack-v0", 0, [0.4, 0.4, 0.4, 0.0]),
    outcome("a", "attack-v0", 1, [0.6, 0.6, 0.6, 0.0]),
    outcome("b", "match-v0", 0, [0.0, 0.0, 0.0, 0.0]),
]


def _write(root: Path, runs: list[dict[str, Any]]) -> Path:
    for run in runs:
        folder = root / run["algorithm"] / run["task"] / f"seed_{run['seed']}"
        folder.mkdir(parents=True)
        (folder / "outcome.json").write_text(json.dumps(run), encoding="utf-8")
    return root


def test_a_tasks_row() -> None:
    row = aggregate.task_row(RUNS[:2], PROTOCOL.kept_out)
    # of 0.9 0.5 0.1 0.9 0.6 0.0 the middle half, one cut off at either end: (0.1 + 0.5 + 0.6 + 0.9) / 4
    assert row["score"]["value"] == pytest.approx(0.525)
    assert row["against_kept_out"]["value"] == pytest.approx(0.3)
    assert row["score"]["low"] < 0.525 <= row["score"]["high"] and row["seeds"] == 2
    assert row["reached"] == {"goalie": {"0.7": {"seeds": 1, "seconds": 1.5, "steps": 100}}}  # a last point is no proof


def test_a_single_seed_has_no_interval() -> None:
    row = aggregate.task_row(RUNS[4:], PROTOCOL.kept_out)
    assert row["score"] == {"value": 0.0, "low": None, "high": None} and row["reached"] == {}


def test_all_tasks_are_summed_up_where_each_was_learnt_as_often() -> None:
    tasks = ["match-v0", "attack-v0"]
    row = aggregate.overall_row(RUNS[:4], PROTOCOL.kept_out, tasks)
    assert row is not None and row["median"] == pytest.approx(0.5)  # means 0.5, 0.5; 0.4, 0.6
    assert aggregate.overall_row(RUNS[:3], PROTOCOL.kept_out, tasks) is None
    assert aggregate.overall_row(RUNS[4:], PROTOCOL.kept_out, tasks) is None
    assert aggregate.overall_row(RUNS[4:], PROTOCOL.kept_out, tasks[:1]) is None  # a single seed


def test_a_performance_profile_falls_from_all_runs_to_none() -> None:
    found = aggregate.profile(RUNS[:4], PROTOCOL.kept_out)
    at = {
        round(float(threshold), 2): float(share) for threshold, share in zip(aggregate.THRESHOLDS, found, strict=True)
    }
    assert (at[0.0], at[0.39], at[0.45], at[0.55], at[1.0]) == (1.0, 1.0, 0.75, 0.25, 0.0)
    assert (np.diff(found) <= 0.0).all()


def test_the_band_of_a_profile_is_as_wide_as_runs_of_one_task_differ() -> None:
    assert aggregate.profile_band(RUNS[:3], PROTOCOL.kept_out) is None  # a single run of the attack
    band = aggregate.profile_band(RUNS[:4], PROTOCOL.kept_out)
    assert band is not None
    low, high = band
    at = {round(float(threshold), 2): k for k, threshold in enumerate(aggregate.THRESHOLDS)}
    # between 0.5 and 0.6 only one of two runs of the attack is above: of two draws none to both, of four runs
    assert (low[at[0.55]], high[at[0.55]]) == (0.0, 0.5)
    # at 0.45 both of the match are above, always, and of the attack none to both
    assert (low[at[0.45]], high[at[0.45]]) == (0.5, 1.0)
    assert (low[at[0.3]], high[at[0.3]]) == (1.0, 1.0)


def test_marl_eval_finds_every_score_at_the_same_steps_of_every_run() -> None:
    tree = aggregate.as_marl_eval([*RUNS, {**RUNS[4], "algorithm": "c", "curve": []}], PROTOCOL.kept_out)["puckpilot"]
    assert tree["match-v0"]["a"]["seed_1"]["absolute_metrics"] == {"score": [0.9, 0.6, 0.0], "score_kept_out": [0.4]}
    assert set(tree["match-v0"]) == {"a", "b"} and set(tree["attack-v0"]["a"]) == {"seed_0", "seed_1"}
    names = {f"step_{k}" for k in range(5)} | {"absolute_metrics"}
    for runs in (run for task in tree.values() for seeds in task.values() for run in seeds.values()):
        assert set(runs) == names
        assert [runs[f"step_{k}"]["step_count"] for k in range(5)] == [60, 120, 180, 240, 300]
    # the curve has points at 100, 200 and 300 steps, 0.8 from the third on
    assert [tree["match-v0"]["a"]["seed_1"][f"step_{k}"]["score"] for k in (0, 3, 4)] == [[0.1], [0.1], [0.8]]


def test_outcomes_are_read_in_the_protocols_order(tmp_path: Path) -> None:
    found = aggregate.read_outcomes(_write(tmp_path, RUNS), PROTOCOL)
    assert [(one["algorithm"], one["task"], one["seed"]) for one in found] == [
        ("a", "match-v0", 0), ("a", "match-v0", 1), ("a", "attack-v0", 0), ("a", "attack-v0", 1), ("b", "match-v0", 0)
    ]  # fmt: skip


@pytest.mark.parametrize(
    ("other", "said"),
    [
        ({"protocol": "0" * 16}, f"c/match-v0/seed_0 is of protocol {'0' * 16}, not of {PROTOCOL.hash}"),
        ({"budget": 999}, "has outcomes of budgets [300, 999]: they cannot be compared; remove some"),
        ({"task": "match-v9"}, "has outcomes of match-v9, which is no task of the protocol"),
        ({"format": "else"}, "is no outcome of puckpilot benchmark run; expected the format puckpilot-outcome/1"),
    ],
)
def test_what_cannot_be_compared_is_refused(other: dict[str, Any], said: str, tmp_path: Path) -> None:
    root = _write(tmp_path, [*RUNS, {**outcome("c", "match-v0", 0, [0.0] * 4), **other}])
    with pytest.raises(ValueError) as error:
        aggregate.read_outcomes(root, PROTOCOL)
    assert said in str(error.value)


def test_an_empty_folder_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match=r"has no outcomes; expected the --out of puckpilot benchmark run"):
        aggregate.read_outcomes(tmp_path, PROTOCOL)


def test_the_report_has_tables_figures_and_raw_scores(tmp_path: Path) -> None:
    root = _write(tmp_path, RUNS)
    found = summary(aggregate.read_outcomes(root, PROTOCOL), PROTOCOL)
    assert found["departs"] == "300 agent steps and 1 of 5 seeds"
    written = write_report(root, RUNS, found, PROTOCOL.kept_out)
    assert [path.name for path in written] == ["report.md", "curves.png", "profiles.png", "marl_eval.json"]
    assert all(path.stat().st_size > 200 for path in written)
    page = page_of(found)
    assert "| a | 2 | 52.5 % (" in page and "| b | 1 | 0.0 % | 0.0 % | 4 |" in page
    assert "- a reached 70 % against goalie in 1 of 2 seeds, after 2 s and 100 steps (medians)" in page
    assert "**Not by the protocol: 300 agent steps and 1 of 5 seeds.**" in page
