"""The confusion matrix: true effects (rows) and diagnosed effects (columns), in counts of cases."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from sim2real.study.scoring import Score

QUIET = ("agrees", "parameters_only", "undetermined", "failed")
SEVERAL = "several"
TRUTHS = {"nothing": "agrees", "parameters": "parameters_only"}  # the correct verdict


@dataclass(frozen=True)
class Confusion:
    """`counts[i][j]` cases with truth `rows[i]` were diagnosed as `columns[j]`; cases with two effects are omitted."""

    rows: tuple[str, ...]
    columns: tuple[str, ...]
    counts: tuple[tuple[int, ...], ...]

    def as_dict(self) -> dict[str, object]:
        """The matrix as plain data."""
        return {"rows": self.rows, "columns": self.columns, "counts": self.counts}


def confuse(scores: Sequence[Score]) -> Confusion:
    """Count the matrix; it has only the rows and columns that occur."""
    pairs = [(_truth(score), _said(score)) for score in scores if score.kind != "two"]
    names = {name for pair in pairs for name in pair}
    quiet, unlisted, several = ([name for name in group if name in names] for group in (QUIET, ["unlisted"], [SEVERAL]))
    named = sorted(names - {*QUIET, "unlisted", SEVERAL})
    columns = (*quiet, *named, *unlisted, *several)
    true = {truth for truth, _ in pairs}
    rows = tuple(name for name in columns if name in true)
    return Confusion(rows, columns, tuple(tuple(pairs.count((row, column)) for column in columns) for row in rows))


def _truth(score: Score) -> str:
    return TRUTHS.get(score.kind) or score.truth[0]


def _said(score: Score) -> str:
    return SEVERAL if len(score.said) > 1 else score.said[0] if score.said else score.verdict


def draw(path: Path, confusion: Confusion) -> None:
    """Draw the matrix: correct counts in green, wrong ones in red, both as shares of the row; a note if it is empty."""
    import numpy as np
    from matplotlib.figure import Figure as Picture

    counts = np.array(confusion.counts, dtype=float).reshape(len(confusion.rows), len(confusion.columns))
    shares = counts / np.maximum(counts.sum(axis=1, keepdims=True), 1.0)
    right = np.array([[row == column for column in confusion.columns] for row in confusion.rows], dtype=bool)
    colours = np.ones((*counts.shape, 3))
    colours[..., 1] -= 0.7 * np.where(right, 0.0, shares)
    colours[..., 2] -= 0.7 * shares
    colours[..., 0] -= 0.6 * np.where(right, shares, 0.0)
    size = 0.34 * max(len(confusion.columns), 4) + 3.2, 0.28 * max(len(confusion.rows), 3) + 2.6
    picture = Picture(figsize=size, layout="constrained")
    axes = picture.add_subplot()
    if confusion.rows:
        axes.imshow(colours, aspect="auto")
    else:
        axes.text(0.5, 0.5, "no case with a single truth", ha="center", va="center", transform=axes.transAxes)
    axes.set_xticks(range(len(confusion.columns)), confusion.columns, rotation=60, ha="right", fontsize=8)
    axes.set_yticks(range(len(confusion.rows)), confusion.rows, fontsize=8)
    axes.set_xlabel("diagnosed")
    axes.set_ylabel("true")
    for i, row in enumerate(confusion.counts):
        for j, count in enumerate(row):
            if count:
                axes.text(j, i, str(count), ha="center", va="center", fontsize=8)
    picture.savefig(path, dpi=150)
