"""Tuned numbers of the formulas."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.statistics.tuned import tuned


@dataclass(frozen=True)
class FormulaNumbers:
    """Grids of nonlinear parameters, and criteria for the choice of a form."""

    # shapes
    periods: tuple[float, ...] = tuned(
        tuple(np.concatenate([np.linspace(0.75, 8.0, 22), np.linspace(8.5, 16.0, 12)])),
        "periods in the range of the data",
        "a sine between two grid points, or time",
        "choice: neighbours differ by a third of a period over the range, above 8 by two thirds",
    )
    decays: tuple[float, float] = tuned(
        (0.03, 1.0), "of the range", "a decay too short or too long to be found", "choice: a few data to all"
    )
    decay_steps: int = tuned(10, "grid points", "a decay between two grid points, or time", "choice: ratio of 1.5")
    middles: int = tuned(7, "grid points", "a bump between two grid points, or time", "choice: eighths of the range")
    widths: tuple[float, ...] = tuned(
        (0.06, 0.12, 0.25), "of the range", "a bump too narrow or too wide to be found", "choice: factors of two"
    )
    soft_edge: float = tuned(
        0.02,
        "of a stripe's width",
        "edges without a derivative for the fit, or blurred edges",
        "choice: hardly visible",
    )
    # search
    columns_at_once: int = tuned(60, "columns", "memory, or time", "choice: more would save little")
    refined: int = tuned(5, "forms", "time of fine fits, or the best form missed on the grid", "choice: a few")
    nearly_all: float = tuned(
        0.98, "of the best form's gain", "many parameters for the last digit of a strong effect", "choice: a fiftieth"
    )
    own_share: float = tuned(0.03, "of a column's norm", "a form that the baseline can fit", "choice: a small share")
    beyond_grid: float = tuned(
        0.1, "of the grid's range", "shapes beyond the data, or an optimum cut off", "choice: a tenth"
    )
    simplex_steps: int = tuned(60, "evaluations", "time", "choice: ample for two parameters")
    simplex_size: float = tuned(
        0.06, "of each parameter", "an optimum of another grid point, or slow steps", "choice: about a grid step"
    )


FORMULA = FormulaNumbers()
