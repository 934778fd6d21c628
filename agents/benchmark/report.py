"""The report of a benchmark's folder: a page of tables, figures of curves and profiles, and JSON for marl-eval."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from agents.benchmark import aggregate
from agents.benchmark.aggregate import Outcome
from agents.benchmark.protocol import Protocol
from puckpilot_env.files.whole_file import write_text_whole, write_whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

HEADINGS = ("algorithm", "seeds", "score", "against the player kept out", "learning, s")


def summary(outcomes: Sequence[Outcome], protocol: Protocol) -> dict[str, Any]:
    """The rows of all tables, by task and algorithm, as JSON can hold them; `overall` has those algorithms alone that
    learnt each task as often."""
    tasks = aggregate.tasks_of(outcomes)
    names = aggregate.algorithms_of(outcomes)
    runs_of = {name: aggregate.of_algorithm(outcomes, name) for name in names}
    per_task = {
        task: {
            name: aggregate.task_row(runs, protocol.kept_out)
            for name in names
            if (runs := aggregate.of_task(runs_of[name], task))
        }
        for task in tasks
    }
    overall = {name: aggregate.overall_row(runs, protocol.kept_out, tasks) for name, runs in runs_of.items()}
    return {
        "protocol": protocol.hash,
        "budget": aggregate.budget_of(outcomes),
        "departs": _departs(outcomes, protocol),
        "tasks": per_task,
        "overall": {name: row for name, row in overall.items() if row},
    }


def _departs(outcomes: Sequence[Outcome], protocol: Protocol) -> str:
    """In what trainings are not the protocol's, in words; "" where they are."""
    words = []
    budget = aggregate.budget_of(outcomes)
    if budget and budget not in protocol.steps:
        words.append(f"{budget:,} agent steps")
    runs = Counter((one["algorithm"], one["task"]) for one in outcomes if one["budget"])
    if runs and min(runs.values()) < protocol.seeds:
        words.append(f"{min(runs.values())} of {protocol.seeds} seeds")
    return " and ".join(words)


def write_report(root: Path, outcomes: Sequence[Outcome], found: dict[str, Any], kept_out: str) -> list[Path]:
    """Write report.md, curves.png, profiles.png and marl_eval.json into the folder; their paths."""
    page, raw = root / "report.md", root / "marl_eval.json"
    write_text_whole(page, page_of(found))
    write_text_whole(raw, json.dumps(aggregate.as_marl_eval(outcomes, kept_out), indent=1) + "\n")
    tasks = aggregate.tasks_of(outcomes)
    curves = _draw(root / "curves.png", len(tasks), lambda axes: _curves(axes, outcomes, tasks, kept_out))
    compared = [one for one in outcomes if one["algorithm"] in found["overall"]]
    if not compared:
        return [page, curves, raw]
    return [page, curves, _draw(root / "profiles.png", 1, lambda axes: _profiles(axes[0], compared, kept_out)), raw]


def rows_of(found: Mapping[str, Any], task: str) -> list[tuple[str, ...]]:
    """The rows of a task's table, as words under HEADINGS."""
    return [
        (name, str(row["seeds"]), interval(row["score"]), interval(row["against_kept_out"]), f"{row['seconds']:.0f}")
        for name, row in found["tasks"][task].items()
    ]


def interval(estimate: dict[str, Any]) -> str:
    """A share with its interval, in per cent; of a single seed, which has none, the share alone."""
    share = f"{100 * estimate['value']:.1f} %"
    if estimate["low"] is None:
        return share
    return f"{share} ({100 * estimate['low']:.1f} to {100 * estimate['high']:.1f})"


def page_of(found: dict[str, Any]) -> str:
    """The page, in Markdown."""
    departs = f"**Not by the protocol: {found['departs']}.** " if found["departs"] else ""
    lines = [
        "# Benchmark", "",
        f"Protocol {found['protocol']}, {found['budget']:,} agent steps of training. {departs}A score is the share of "
        "points in a match, of jobs done in a drill. A figure of a task is the interquartile mean over seeds and "
        "opponents, with its 95 % interval by a bootstrap of whole seeds; a single seed has none. Seconds of learning "
        "include, of the first training of a process, those of compilation.", "",
    ]  # fmt: skip
    for task in found["tasks"]:
        lines += [f"## {task}", "", *_markdown(HEADINGS, rows_of(found, task)), "", *_reached_words(found, task)]
    if found["overall"]:
        rows = [
            (name, str(row["seeds"]), interval(row["score"]), f"{100 * row['median']:.1f} %")
            for name, row in found["overall"].items()
        ]
        lines += [
            "## All tasks",
            "",
            "Of the means over opponents the interquartile mean over tasks and seeds, and the median.",
            "",
            *_markdown(("algorithm", "seeds", "score", "median"), rows),
            "",
        ]
    lines += ["![Learning curves](curves.png)", ""]
    if found["overall"]:
        words = (
            "The share of runs above each score; shaded, pointwise 95 % intervals by a bootstrap of each task's runs."
        )
        lines += [words, "", "![Performance profiles](profiles.png)", ""]
    return "\n".join(lines)


def _markdown(headings: Sequence[str], rows: Sequence[Sequence[str]]) -> list[str]:
    return [f"| {' | '.join(row)} |" for row in (headings, ["---"] * len(headings), *rows)]


def _reached_words(found: dict[str, Any], task: str) -> list[str]:
    lines = [
        f"- {name} reached {100 * float(level):g} % against {opponent} in {at['seeds']} of {row['seeds']} "
        f"seeds, after {at['seconds']:.0f} s and {at['steps']:,} steps (medians)"
        for name, row in found["tasks"][task].items()
        for opponent, levels in row["reached"].items() for level, at in levels.items()
    ]  # fmt: skip
    return [*lines, ""] if lines else []


def _curves(axes: Sequence[Axes], outcomes: Sequence[Outcome], tasks: Sequence[str], kept_out: str) -> None:
    for one, task in zip(axes, tasks, strict=True):
        for name in aggregate.algorithms_of(outcomes):
            runs = aggregate.of_task(aggregate.of_algorithm(outcomes, name), task)
            if not runs:
                continue
            colour = f"C{aggregate.algorithms_of(outcomes).index(name)}"
            if not runs[0]["curve"]:
                level = aggregate.scores(runs, kept_out).mean()
                one.axhline(float(level), color=colour, linestyle=":", label=name)
            for number, run in enumerate(run for run in runs if run["curve"]):
                steps = [1e-6 * point["steps"] for point in run["curve"]]
                means = [np.mean(list(point["scores"].values())) for point in run["curve"]]
                one.plot(steps, means, color=colour, alpha=0.7, label="" if number else name)
        one.set(
            title=task, xlabel="agent steps, million", ylabel="score, mean of the task's opponents", ylim=(-0.02, 1.02)
        )
    axes[0].legend(fontsize=7)


def _profiles(axes: Axes, outcomes: Sequence[Outcome], kept_out: str) -> None:
    for name in aggregate.algorithms_of(outcomes):
        runs = aggregate.of_algorithm(outcomes, name)
        (line,) = axes.plot(aggregate.THRESHOLDS, aggregate.profile(runs, kept_out), label=name)
        band = aggregate.profile_band(runs, kept_out)
        if band is not None:
            axes.fill_between(aggregate.THRESHOLDS, *band, color=line.get_color(), alpha=0.15, linewidth=0.0)
    axes.set(xlabel="score τ", ylabel="share of runs with a score above τ", ylim=(-0.02, 1.02))
    axes.legend(fontsize=8)


def _draw(path: Path, count: int, fill: Callable[[Sequence[Axes]], None]) -> Path:
    """A figure of `count` axes, filled and written whole."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    across = min(count, 3)
    down = -(-count // across)
    figure = Figure(figsize=(4.2 * across, 3.2 * down), layout="constrained")
    FigureCanvasAgg(figure)
    axes = [figure.add_subplot(down, across, number + 1) for number in range(count)]
    fill(axes)
    return write_whole(path, lambda draft: figure.savefig(draft, dpi=110, metadata={"Software": None}))
