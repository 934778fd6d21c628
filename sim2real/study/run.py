"""A study from its plan to its files: make the cases, have them diagnosed, open the keys, write what came out."""

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
from sim2real.study.version import code_version


@dataclass(frozen=True)
class Study:
    """What came out. `peer_*`: the same for PySINDy on the cases that it can be asked about, else empty."""

    plan: Plan
    scores: list[Score]
    figures: list[Figure]
    by_mechanism: list[Figure]
    confusion: matrix.Confusion
    peer_scores: list[Score]
    peer_figures: list[Figure]

    def as_dict(self) -> dict[str, Any]:
        """The same as plain data."""
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
    """Run the study in `folder`, or go on with it. Raises ValueError where another study is in the way."""
    from baselines.commands.options import progress_bar
    from sim2real.study.peer import PEER, can_be_asked

    note = _claim(folder, plan, tool, heldout)
    if note:
        print(note, file=sys.stderr)
    with progress_bar("cases made") as progress:
        try:
            labels = make_cases(plan, folder, workers, progress)
        except ValueError:
            if not (folder / "recordings").exists():  # such a study there is not: the folder is free for another
                (folder / "plan.json").unlink()
            raise
    with progress_bar("cases diagnosed") as progress:
        answers = diagnose_cases(folder, labels, tool or THIS, "diagnoses", heldout, workers, progress)
    keys = {label: json.loads((folder / "key" / f"{label}.json").read_text()) for label in labels}
    asked_of_peer = [label for label in labels if peer and can_be_asked(keys[label])]
    with progress_bar("cases put to PySINDy") as progress:
        replies = diagnose_cases(folder, asked_of_peer, PEER, "peer", False, workers, progress)
    scores = [score(label, keys[label], answers[label]) for label in labels]
    peer_scores = [score(label, keys[label], replies[label]) for label in asked_of_peer]
    study = Study(
        plan=plan,
        scores=scores,
        figures=figures(scores, plan.seconds),
        by_mechanism=by_mechanism(scores),
        confusion=matrix.confuse(scores),
        peer_scores=peer_scores,
        peer_figures=figures(peer_scores, plan.seconds) if asked_of_peer else [],
    )
    write_text_whole(folder / "study.json", json.dumps(study.as_dict(), indent=1) + "\n")
    write_whole(folder / "confusion.png", lambda draft: matrix.draw(draft, study.confusion))
    return study


def _claim(folder: Path, plan: Plan, tool: Sequence[str] | None, heldout: bool) -> str:
    """Write down what the folder holds; ValueError where it holds something else. Another number of cases of the same
    study is welcome; what that does to the files there is returned in a line, "" where nothing."""
    note, told = folder / "plan.json", ""
    wanted = {**plan.as_dict(), "tool": tool, "heldout": heldout, "code": code_version(ROOT)}
    if note.exists():
        there = json.loads(note.read_text())
        other = [name for name, value in wanted.items() if name != "cases" and there.get(name) != value]
        if other:
            parts = ", ".join(f"{name} {there.get(name)}" for name in other)
            raise ValueError(f"{folder} holds another study ({parts}); name another folder with --out")
        before = there.get("cases")
        if before != plan.cases and (folder / "study.json").exists():
            told = f"{folder} holds this study with {before} cases: study.json and confusion.png will tell {plan.cases}"
    folder.mkdir(parents=True, exist_ok=True)
    write_text_whole(note, json.dumps(wanted) + "\n")
    return told
