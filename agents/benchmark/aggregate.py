"""What outcomes of several seeds say together: interquartile means with intervals, and times until scripts are beaten.

The measures are those of Agarwal et al., "Deep reinforcement learning at the edge of the statistical precipice",
NeurIPS 2021, as in `agents.evaluation.over_seeds`.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from agents.benchmark.protocol import Protocol
from agents.benchmark.training import read_outcome
from agents.evaluation.over_seeds import RESAMPLES, TAIL, iqm_estimate

Outcome = Mapping[str, Any]
CURVE_STEPS = 5  # parts of the budget, for marl-eval
LEVELS = (0.7, 0.95)  # scores that a learning curve may reach
THRESHOLDS = np.linspace(0.0, 1.0, 101)  # of a performance profile


def read_outcomes(root: Path, protocol: Protocol) -> list[Outcome]:
    """All outcomes in a benchmark's folder, by algorithm, the protocol's order of tasks, and seed. ValueError, in one
    line, where there are none, or some of another protocol or of several budgets."""
    found = [read_outcome(file) for file in sorted(root.glob("*/*/seed_*/outcome.json"))]
    if not found:
        raise ValueError(f"{root} has no outcomes; expected the --out of puckpilot benchmark run")
    for one in found:
        if one["protocol"] != protocol.hash:
            where = f"{one['algorithm']}/{one['task']}/seed_{one['seed']}"
            raise ValueError(f"{where} is of protocol {one['protocol']}, not of {protocol.hash}, which is played here")
    budgets = sorted({one["budget"] for one in found if one["budget"]})
    if len(budgets) > 1:
        words = "they cannot be compared; remove some of its folders, or run each budget in an --out of its own"
        raise ValueError(f"{root} has outcomes of budgets {budgets}: {words}")
    order = list(protocol.tasks)
    if other := [one["task"] for one in found if one["task"] not in order]:
        raise ValueError(f"{root} has outcomes of {other[0]}, which is no task of the protocol")
    return sorted(found, key=lambda one: (one["algorithm"], order.index(one["task"]), one["seed"]))


def budget_of(outcomes: Iterable[Outcome]) -> int:
    """The budget of those that learnt; 0 where none did."""
    return max(one["budget"] for one in outcomes)


def of_algorithm(outcomes: Iterable[Outcome], algorithm: str) -> list[Outcome]:
    """Those of one algorithm."""
    return [one for one in outcomes if one["algorithm"] == algorithm]


def of_task(outcomes: Iterable[Outcome], task: str) -> list[Outcome]:
    """Those of one task."""
    return [one for one in outcomes if one["task"] == task]


def algorithms_of(outcomes: Iterable[Outcome]) -> list[str]:
    """The algorithms, in the outcomes' order."""
    return list(dict.fromkeys(one["algorithm"] for one in outcomes))


def tasks_of(outcomes: Iterable[Outcome]) -> list[str]:
    """The tasks, in the outcomes' order."""
    return list(dict.fromkeys(one["task"] for one in outcomes))


def scores(outcomes: Sequence[Outcome], kept_out: str, against_kept_out: bool = False) -> NDArray[np.float64]:
    """Scores (seeds, opponents) of one algorithm on one task, against the task's opponents or the one kept out."""
    return np.array(
        [[row["score"] for row in one["evaluation"] if (row["opponent"] == kept_out) == against_kept_out]
         for one in outcomes]
    )  # fmt: skip


def task_row(outcomes: Sequence[Outcome], kept_out: str) -> dict[str, Any]:
    """One algorithm on one task: IQM over seeds and opponents, that against the player kept out, and when its learning
    curves reached LEVELS."""
    return {
        "seeds": len(outcomes),
        "score": _of_seeds(scores(outcomes, kept_out)),
        "against_kept_out": _of_seeds(scores(outcomes, kept_out, against_kept_out=True)),
        "seconds": float(np.median([each["seconds"] for each in outcomes])),
        "reached": _reached(outcomes),
    }


def overall_row(outcomes: Sequence[Outcome], kept_out: str, tasks: Sequence[str]) -> dict[str, Any] | None:
    """One algorithm over all tasks: the IQM over seeds and tasks of the mean score against opponents, and the median
    over all, with an interval stratified by task, of which each was learnt by itself; None for a single seed, and if it
    did not learn each task with as many."""
    of_tasks = [scores(of_task(outcomes, task), kept_out) for task in tasks]
    if any(one.ndim < 2 or len(one) != len(of_tasks[0]) or len(one) < 2 for one in of_tasks):
        return None
    means = np.column_stack([one.mean(axis=1) for one in of_tasks])
    return {
        "seeds": len(means),
        "score": iqm_estimate(means, separately=True).as_dict(),
        "median": float(np.median(means)),
    }


def profile(outcomes: Sequence[Outcome], kept_out: str) -> NDArray[np.float64]:
    """The share (thresholds,) of runs, over tasks and seeds alike, whose mean score is above each of THRESHOLDS."""
    means = np.array([scores([one], kept_out).mean() for one in outcomes])
    return np.mean(means[:, None] > THRESHOLDS, axis=0)


def profile_band(outcomes: Sequence[Outcome], kept_out: str, seed: int = 0) -> NDArray[np.float64] | None:
    """Ends (2, thresholds) of pointwise 95 % intervals of `profile`, by a bootstrap of the runs of each task; None
    where a task has a single one."""
    means = [scores(of_task(outcomes, task), kept_out).mean(axis=1) for task in tasks_of(outcomes)]
    if min(map(len, means)) < 2:
        return None
    rng, above = np.random.default_rng(seed), []
    for of_one in means:
        drawn = of_one[rng.integers(len(of_one), size=(RESAMPLES, len(of_one)))]
        above.append((drawn[:, :, None] > THRESHOLDS).sum(axis=1))
    shares = np.sum(above, axis=0) / sum(map(len, means))
    return np.quantile(shares, [TAIL, 1.0 - TAIL], axis=0)


def _of_seeds(scores_of_seeds: NDArray[np.float64]) -> dict[str, float | None]:
    """The IQM of scores (seeds, opponents) with its interval, whose ends are None for a single seed."""
    found = iqm_estimate(scores_of_seeds).as_dict()
    return found if len(scores_of_seeds) > 1 else {**found, "low": None, "high": None}


def _reached(outcomes: Sequence[Outcome]) -> dict[str, dict[str, dict[str, float | int]]]:
    """For each opponent and each of LEVELS: in how many seeds the curve reached it, at two points in a row, and the
    median over these seeds of the seconds of learning and the agent steps at the first. None is there for a level that
    no seed reached."""
    found: dict[str, dict[str, dict[str, float | int]]] = {}
    opponents = outcomes[0]["curve"][0]["scores"] if outcomes[0]["curve"] else {}
    for opponent in opponents:
        for level in LEVELS:
            first = [_first(one["curve"], opponent, level) for one in outcomes]
            there = [point for point in first if point]
            if there:
                found.setdefault(opponent, {})[f"{level:g}"] = {
                    "seeds": len(there),
                    "seconds": float(np.median([point["seconds"] for point in there])),
                    "steps": int(np.median([point["steps"] for point in there])),
                }
    return found


def _first(curve: Sequence[Mapping[str, Any]], opponent: str, level: float) -> Mapping[str, Any] | None:
    both = (two for two in pairwise(curve) if min(point["scores"][opponent] for point in two) >= level)
    return next(both, (None, None))[0]


def as_marl_eval(outcomes: Sequence[Outcome], kept_out: str) -> dict[str, Any]:
    """The outcomes as the JSON that marl-eval reads (Gorsane et al., NeurIPS 2022): environment, task, algorithm, seed,
    steps. The metric `score` has a value for each opponent, `score_kept_out` that against the player kept out.

    It wants the same steps of every run, so these are parts of the budget, CURVE_STEPS, with the newest point of the
    curve by then; what has no curve is left out.
    """
    tree: dict[str, Any] = {}
    for one in outcomes:
        if not one["curve"]:
            continue
        runs = tree.setdefault(one["task"], {}).setdefault(one["algorithm"], {})
        run: dict[str, Any] = {f"step_{k}": _part(one, k + 1) for k in range(CURVE_STEPS)}
        run["absolute_metrics"] = {
            "score": scores([one], kept_out)[0].tolist(),
            "score_kept_out": scores([one], kept_out, against_kept_out=True)[0].tolist(),
        }
        runs[f"seed_{one['seed']}"] = run
    return {"puckpilot": tree}


def _part(outcome: Outcome, part: int) -> dict[str, Any]:
    steps = outcome["budget"] * part // CURVE_STEPS
    point = next((each for each in reversed(outcome["curve"]) if each["steps"] <= steps), outcome["curve"][0])
    return {"step_count": steps, "elapsed_time": point["seconds"], "score": list(point["scores"].values())}
