"""The comparison method: PySINDy's sparse regression on the accelerations of a gliding puck.

`python -m sim2real.study.peer diagnose RECORDING --out DIR` writes the same format as puckpilot, so that both are
scored in the same way.

PySINDy gets this project's segmentation into glides. Its library contains the true law of every glide mechanism (a
friction patch as a grid of discs), as vectors, so that x and y share their coefficients. Derivatives are its
SmoothedFiniteDifference, applied twice, without the frames at the ends. The threshold of STLSQ (columns normalized) is
chosen by cross-validation over glides: the sparsest model that is worse than the best by no more than one standard
error of the difference (Hastie, Tibshirani and Friedman, 2009, section 7.10). Intervals come from a bootstrap over
glides with the selected terms.
"""

from __future__ import annotations

import argparse
import json
import sys
import warnings
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

PEER = (sys.executable, "-m", "sim2real.study.peer")
WINDOW, ORDER = 45, 3  # frames and degree of the smoother
SLOW = 0.15  # m/s, speed below which the heading is mostly noise
THRESHOLDS = np.geomspace(0.003, 1.0, 24)  # of the acceleration's rms
FOLDS, RESAMPLES = 5, 200
# term: (mechanism, its parameter, unit); the baseline's own two have no mechanism
TERMS: dict[str, tuple[str | None, str, str]] = {
    "friction": (None, "friction", "m/s^2"),
    "drag": (None, "drag", "1/m"),
    "tilt_x": ("table_tilt", "tilt_x", "m/s^2"),
    "tilt_y": ("table_tilt", "tilt_y", "m/s^2"),
    "warp_xx": ("table_warp", "warp_xx", "1/s^2"),
    "warp_yy": ("table_warp", "warp_yy", "1/s^2"),
    "warp_xy": ("table_warp", "warp_xy", "1/s^2"),
    "linear": ("linear_drag", "k", "1/s"),
    "late": ("air_drift", "friction_rate", "m/s^3"),
    "heading": ("friction_anisotropy", "friction_difference", "m/s^2"),
    "across": ("side_force", "coefficient", "1/s"),
}
DISCS = (5, 3)  # along x and y


def can_be_asked(key: dict[str, Any]) -> bool:
    """Whether a case is of gliding only: a puck without mallets, and nothing missing outside of the glides."""
    return key["scenario"] in ("launches", "posts") and set(key["regimes"]) <= {"glide"}


def accelerations(recording: Any) -> list[np.ndarray]:
    """The arrays (n, 7) of all glides that are long enough: t, x, y, vx, vy, ax, ay."""
    from pysindy import SmoothedFiniteDifference

    from sim2real.segmentation.segments import segment

    glides = []
    for glide in segment(recording).glides:
        if len(glide.t) < WINDOW + 8:
            continue
        slope: Any = SmoothedFiniteDifference(smoother_kws={"window_length": WINDOW, "polyorder": ORDER})
        place = np.stack([glide.x, glide.y], axis=1)
        velocity = np.asarray(slope(place, glide.t))
        rows = np.column_stack([glide.t, place, velocity, np.asarray(slope(velocity, glide.t))])
        rows = rows[WINDOW // 2 : -(WINDOW // 2)]
        rows = rows[np.hypot(rows[:, 3], rows[:, 4]) > SLOW]
        if len(rows):
            glides.append(rows)
    return glides


def library(rows: np.ndarray, length: float, width: float) -> np.ndarray:
    """The accelerations (2 n, terms) of the library's terms: x, then y."""
    t, x, y, vx, vy = rows[:, :5].T
    v = np.hypot(vx, vy)
    along, zero, one = np.stack([-vx / v, -vy / v]), np.zeros_like(v), np.ones_like(v)
    dx, dy = x - 0.5 * length, y - 0.5 * width
    terms = [along, along * v * v, np.stack([one, zero]), np.stack([zero, one])]
    terms += [np.stack([-dx, zero]), np.stack([zero, -dy]), np.stack([-dy, -dx])]
    terms += [along * v, along * t, along * (vx**2 - vy**2) / v**2, np.stack([-vy, vx])]
    for i in range(DISCS[0]):
        for j in range(DISCS[1]):
            away = np.hypot(x - (i + 0.5) / DISCS[0] * length, y - (j + 0.5) / DISCS[1] * width)
            terms.append(along * (away < 0.5 * width / DISCS[1] * np.sqrt(2.0)))
    return np.stack([term.ravel() for term in terms], axis=1)


def reduce(rows: np.ndarray, length: float, width: float) -> np.ndarray:
    """Reduce the regression of a glide to R (terms + 1, terms + 1) of its QR decomposition, with the target last.

    Least squares and the norms of the columns are the same for R as for all frames.
    """
    table = np.column_stack([library(rows, length, width), rows[:, 5:].T.ravel()])
    return np.asarray(np.linalg.qr(table, mode="r"))


def choose_terms(parts: Sequence[np.ndarray], seed: int = 0) -> np.ndarray:
    """The terms (bool) that the sparse regression selects, at the threshold from cross-validation over glides."""
    fold = np.random.default_rng(seed).permutation(len(parts)) % FOLDS
    errors = np.empty((FOLDS, len(THRESHOLDS)))
    for k in range(FOLDS):
        train = np.concatenate([part for part, f in zip(parts, fold, strict=True) if f != k])
        test = np.concatenate([part for part, f in zip(parts, fold, strict=True) if f == k])
        for i, threshold in enumerate(THRESHOLDS):
            errors[k, i] = np.sum((test[:, -1] - test[:, :-1] @ sparse(train, threshold)) ** 2)
    errors -= errors[:, [np.argmin(errors.sum(axis=0))]]
    worse, spread = errors.mean(axis=0), errors.std(axis=0, ddof=1) / np.sqrt(FOLDS)
    return sparse(np.concatenate(parts), float(THRESHOLDS[np.flatnonzero(worse <= spread)[-1]])) != 0.0


def sparse(rows: np.ndarray, threshold: float) -> np.ndarray:
    """Coefficients (terms,) of STLSQ on rows of terms and target."""
    from pysindy import STLSQ

    terms, target = rows[:, :-1], rows[:, -1:]
    kept = np.linalg.norm(terms, axis=0) > 0.0  # drop discs that no puck crossed
    optimizer = STLSQ(threshold=threshold * float(np.linalg.norm(target)), alpha=1e-9, normalize_columns=True)
    coefficients = np.zeros(terms.shape[1])
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # PySINDy warns if no term remains
        coefficients[kept] = np.ravel(optimizer.fit(terms[:, kept], target).coef_)
    return coefficients


def diagnose(folder: Path) -> dict[str, Any]:
    """Diagnose the recording in `folder`; the result has the format puckpilot-diagnosis/1, without a holdout proof."""
    from sim2real.recording.folder import read_recording

    recording = read_recording(folder)
    length, width = (recording.meta["table"][name] for name in ("length_m", "width_m"))
    glides = accelerations(recording)
    if len(glides) < FOLDS:
        return {"format": "puckpilot-diagnosis/1", "verdict": "undetermined", "findings": []}
    parts = [reduce(glide, length, width) for glide in glides]
    kept = choose_terms(parts)
    estimates = _estimates(parts, kept)
    names = [*TERMS, *(f"disc {k}" for k in range(DISCS[0] * DISCS[1]))]
    found: dict[str, dict[str, Any]] = {}
    for name, estimate in zip([n for n, k in zip(names, kept, strict=True) if k], estimates, strict=True):
        mechanism, label, unit = TERMS.get(name, ("friction_patch", name, "m/s^2"))
        if mechanism is not None:
            found.setdefault(mechanism, {})[label] = {**estimate, "unit": unit}
    findings = [
        {"regime": "glide", "mechanism": mechanism, "also_possible": [], "parameters": parameters}
        for mechanism, parameters in found.items()
    ]
    verdict = "missing_physics" if findings else "parameters_only"
    return {"format": "puckpilot-diagnosis/1", "verdict": verdict, "findings": findings}


def _estimates(parts: Sequence[np.ndarray], kept: np.ndarray) -> list[dict[str, float]]:
    """Least-squares estimates of the selected terms, with percentiles of a bootstrap over glides."""
    equations = np.array([part[:, :-1][:, kept].T @ part[:, :-1][:, kept] for part in parts])
    sides = np.array([part[:, :-1][:, kept].T @ part[:, -1] for part in parts])
    rng = np.random.default_rng(0)
    draws = [np.arange(len(parts)), *(rng.integers(len(parts), size=len(parts)) for _ in range(RESAMPLES))]
    fits = np.array([np.linalg.lstsq(equations[d].sum(axis=0), sides[d].sum(axis=0), rcond=None)[0] for d in draws])
    low, high = np.quantile(fits[1:], (0.025, 0.975), axis=0)
    value = fits[0]
    rows = zip(value, np.minimum(low, value), np.maximum(high, value), strict=True)
    return [{"value": float(v), "low": float(a), "high": float(b)} for v, a, b in rows]


def main(arguments: Sequence[str] | None = None) -> int:
    """The command line that the study calls."""
    parser = argparse.ArgumentParser(description="PySINDy's answer, in the form of a diagnosis")
    parser.add_argument("command", choices=["diagnose"])
    parser.add_argument("recording", type=Path)
    parser.add_argument("--out", type=Path, required=True)
    args = parser.parse_args(arguments)
    args.out.mkdir(parents=True, exist_ok=True)
    (args.out / "diagnosis.json").write_text(json.dumps(diagnose(args.recording), indent=1) + "\n")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
