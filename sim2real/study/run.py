"""Run a study: make the cases, diagnose them, score them against the keys, and write the results."""

from __future__ import annotations

import json
import sys
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from puckpilot_env.files.whole_file import write_text_whole, write_whole
from sim2real.study import confusion as matrix
from sim2real.study.diagnosing import THIS, diagnose_cases
from sim2real.study.figures import Figure, by_mechanism, figures
from sim2real.study.making import ROOT, Plan, make_cases
from sim2real.study.scoring import Score, score
from sim2real.study.version import OF_STUDIES, code_version


@dataclass(frozen=True)
class Study:
    """The results of a study. `peer_*`: those of PySINDy on the cases of gliding only, else empty."""

    plan: Plan
    scores: list[Score]
    figures: list[Figure]
    by_mechanism: list[Figure]
    confusion: matrix.Confusion
    peer_scores: list[Score]
    peer_figures: list[Figure]

    def as_dict(self) -> dict[str, Any]:
        """The results as plain data."""
        return {
            "plan": self.plan.as_dict(),
            "figures": [figure.as_dict() for figure in self.figures],
            "by_mechanism": [figure.as_dict() for figure in self.by_mechanism],
            "confusion": self.confusion.as_dict(),
            "peer": [figure.as_dict() for figure in self.peer_figures],
            "cases": [one.as_dict() for one in self.scores],
            "peer_cases": [one.as_dict() for one in self.peer_scores],
        }


def run_study(
    plan: Plan, folder: Path, workers: int, tool: Sequence[str] | None = None, heldout: bool = False, peer: bool = False
) -> Study:
    """Run or resume the study in `folder`. Raises ValueError if the folder contains another study."""
    from baselines.commands.options import progress_bar
    from sim2real.study.peer import PEER, can_be_asked

    note = _claim(folder, plan, tool, heldout)
    if note:
        print(note, file=sys.stderr)
    with progress_bar("cases made") as progress:
        try:
            labels = make_cases(plan, folder, workers, progress)
        except ValueError:
            if not (folder / "recordings").exists():  # the plan is invalid: release the folder
                (folder / "plan.json").unlink()
            raise
    with progress_bar("cases diagnosed") as progress:
        answers = diagnose_cases(folder, labels, tool or THIS, "diagnoses", heldout, workers, progress)
    keys = {label: json.loads((folder / "key" / f"{label}.json").read_text()) for label in labels}
    peer_labels = [label for label in labels if peer and can_be_asked(keys[label])]
    with progress_bar("cases diagnosed by PySINDy") as progress:
        replies = diagnose_cases(folder, peer_labels, PEER, "peer", False, workers, progress)
    scores = [score(label, keys[label], answers[label]) for label in labels]
    peer_scores = [score(label, keys[label], replies[label]) for label in peer_labels]
    study = Study(
        plan=plan,
        scores=scores,
        figures=figures(scores, plan.seconds),
        by_mechanism=by_mechanism(scores),
        confusion=matrix.confuse(scores),
        peer_scores=peer_scores,
        peer_figures=figures(peer_scores, plan.seconds) if peer_labels else [],
    )
    write_text_whole(folder / "study.json", json.dumps(study.as_dict(), indent=1) + "\n")
    write_whole(folder / "confusion.png", lambda draft: matrix.draw(draft, study.confusion))
    return study


def _claim(folder: Path, plan: Plan, tool: Sequence[str] | None, heldout: bool) -> str:
    """Record the plan in the folder. Raises ValueError if the folder contains another study.

    The same study may continue with another number of cases; then a note on the existing result files is returned, else
    "".
    """
    note, message = folder / "plan.json", ""
    wanted = {**plan.as_dict(), "tool": tool, "heldout": heldout, "code": code_version(ROOT, OF_STUDIES)}
    if note.exists():
        there = json.loads(note.read_text())
        other = [name for name, value in wanted.items() if name != "cases" and there.get(name) != value]
        if other:
            parts = ", ".join(f"{name} {there.get(name)}" for name in other)
            raise ValueError(f"{folder} contains another study ({parts}); name another folder with --out")
        before = there.get("cases")
        if before != plan.cases and (folder / "study.json").exists():
            message = (
                f"{folder} contains this study with {before} cases: study.json and confusion.png are rewritten for "
                f"{plan.cases}"
            )
    folder.mkdir(parents=True, exist_ok=True)
    write_text_whole(note, json.dumps(wanted) + "\n")
    return message
