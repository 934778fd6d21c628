"""A network of a table's residuals, fitted to its recordings, and what it makes of steps that it never saw."""

from __future__ import annotations

import importlib.util
import json
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from puckpilot_env.files.whole_file import write_text_whole
from puckpilot_env.residual.network import OUTPUTS, Residual
from sim2real.gap.residual_data import Samples, read_samples

FORMAT = "puckpilot-residual-fit/1"
LEAST = 50  # samples
HELD_OUT = 5  # of so many blocks one is held out
HIDDEN = (32, 32)
MOST = 0.99  # share of the samples whose residual is no larger than what is learnt, and than any correction
SMALLEST = 1e-9  # m, m/s or V by which an input or a residual spreads
HOW: dict[str, Any] = {
    "hidden_layer_sizes": HIDDEN, "activation": "tanh", "alpha": 1.0, "batch_size": 64, "learning_rate_init": 3e-3,
    "max_iter": 2000, "early_stopping": True, "validation_fraction": 0.15, "n_iter_no_change": 40, "random_state": 0,
}  # fmt: skip
"""Of scikit-learn's MLPRegressor. alpha, of 1e-4, 0.1 and 1, is best on what was held out of three tables."""


def require_sklearn() -> None:
    """ValueError, in one line, where scikit-learn is not installed."""
    if importlib.util.find_spec("sklearn") is None:
        raise ValueError("a network of residuals needs scikit-learn; install it with: pip install 'puckpilot[train]'")


def write_residual(recordings: Sequence[Path], values: Mapping[str, float], path: Path) -> Path:
    """Fit a network of what the simulator of the parameters `values` lacks to recordings, write it to `path` (.npz),
    and beside it, as .json, how good it is; returns `path`. ValueError, in one line, for recordings that cannot be
    read, are of a table of other sizes, or show too few steps."""
    residual, report = fit_residual(read_samples(recordings, values))
    residual.save(path)
    write_text_whole(path.with_suffix(".json"), json.dumps(report, indent=1) + "\n")
    return path


def fit_residual(samples: Samples) -> tuple[Residual, dict[str, Any]]:
    """The network, and a report as JSON can hold it: numbers of samples that were fitted and held out, and of the
    latter, for each of x, y, vx, vy [m, m/s], the root mean square and the median size of the residuals, before and
    after. ValueError, in one line, for fewer than LEAST samples, or all from one place of the recordings."""
    require_sklearn()
    pieces = np.unique(samples.blocks)
    if len(samples) < LEAST or len(pieces) < HELD_OUT:
        raise ValueError(
            f"the recordings show {len(samples)} steps with a puck that glides at both ends, from {len(pieces)} pieces "
            f"of 5 s; expected {LEAST} from {HELD_OUT} or more: record more games, with the opponent's mallet in view"
        )
    held_out = np.isin(samples.blocks, pieces[HELD_OUT - 1 :: HELD_OUT])
    residual = _fitted(samples.inputs[~held_out], samples.missed[~held_out])
    before = samples.missed[held_out]
    after = before - residual(samples.inputs[held_out])
    report: dict[str, Any] = {"format": FORMAT, "samples": int((~held_out).sum()), "held_out": int(held_out.sum())}
    for name, of in (
        ("rms", lambda off: np.sqrt((off**2).mean(axis=0))),
        ("median", lambda off: np.median(off, axis=0)),
    ):
        numbers = zip(OUTPUTS, of(np.abs(before)), of(np.abs(after)), strict=True)
        report[name] = {output: {"before": float(b), "after": float(a)} for output, b, a in numbers}
    return residual, report


def _fitted(inputs: np.ndarray, missed: np.ndarray) -> Residual:
    """The network for inputs (n, 18) and residuals (n, 4). The largest hundredth of these count as no larger than the
    rest: hits that were just missed would outweigh everything else."""
    from sklearn.neural_network import MLPRegressor

    bound = np.quantile(np.abs(missed), MOST, axis=0)
    missed = np.clip(missed, -bound, bound)
    centre, span = inputs.mean(axis=0, dtype=np.float64), np.maximum(inputs.std(axis=0, dtype=np.float64), SMALLEST)
    middle, scale = missed.mean(axis=0), np.maximum(missed.std(axis=0), SMALLEST)
    regressor = MLPRegressor(**HOW).fit((inputs - centre) / span, (missed - middle) / scale)
    weights = [np.asarray(one, np.float32).T for one in regressor.coefs_]
    biases = [np.asarray(one, np.float32) for one in regressor.intercepts_]
    return Residual(weights, biases, *(np.asarray(one, np.float32) for one in (centre, span, middle, scale, bound)))
