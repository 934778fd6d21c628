"""Recordings of the reference table as a calibrated camera would have made them.

Errors are those that `puckpilot track` has on rendered pictures: noise that hangs together for two frames, and a smooth
field over the table, drawn from polynomials as twelve calibrations of rendered tables had them (x errs more than y,
since the camera looks along the table).
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
from numpy.polynomial.legendre import legvander2d

from sim2real.recording import Recording, Stream, read_recording
from tests.reality.camera import Camera
from tests.reality.law import Law
from tests.reality.record import make_recording

NOISE, SLOW, MEMORY = 2e-5, 0.75, 0.0125  # m; share of its variance that fades; s
STATED = 1.8e-4  # m, by the calibration
FIELD = ((0.45, 0.035), (0.2, 0.035))  # std of x's and y's coefficients up to the third order and beyond, times STATED
ORDER = 5
BEAM = 0.05  # m on either side of the robot's mallet, along the table, that its gantry hides


def filmed(folder: Path, law: Law, scenario: str, seed: int, seconds: float, stated: bool = True) -> Recording:
    """Nothing of its numbers is told; what the calibration errs by is `stated` or not."""
    make_recording(folder, law, scenario, seed, seconds, Camera(noise=1e-9, jitter=0.0))
    made, rng = read_recording(folder), np.random.default_rng([seed, 7])
    assert made.frames is not None
    t = made.frames.t
    place = np.stack([made.frames["puck_x"], made.frames["puck_y"]], axis=1)
    place = place + _field(place / (law.length, law.width), rng) + _noise(t, rng)
    if made.mallet is not None:
        place[np.abs(place[:, 0] - np.interp(t, made.mallet.t, made.mallet["mallet_x"])) < BEAM] = np.nan
    columns = {**made.frames.columns, "puck_x": place[:, 0], "puck_y": place[:, 1]}
    camera = {"rate_hz": 120.0, "position_std_m": None, "place_std_m": STATED if stated else None}
    return replace(made, meta={**made.meta, "camera": camera}, frames=Stream(columns))


def _field(share: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Errors (n, 2) [m] at places, as shares (n, 2) of the table."""
    x, y = np.clip(2.0 * np.nan_to_num(share) - 1.0, -1.0, 1.0).T
    every = legvander2d(x, y, [ORDER, ORDER])
    order = np.add.outer(np.arange(ORDER + 1), np.arange(ORDER + 1)).ravel()
    sizes = np.array([np.where(order <= 3, low, np.where(order <= ORDER, high, 0.0)) for low, high in FIELD])
    return STATED * every @ (sizes * rng.normal(size=sizes.shape)).T


def _noise(t: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    slow, fresh = np.zeros((len(t), 2)), rng.normal(size=(len(t), 2))
    fading = np.exp(-np.diff(t, prepend=t[:1]) / MEMORY)
    for k in range(1, len(t)):
        slow[k] = fading[k] * slow[k - 1] + np.sqrt(1.0 - fading[k] ** 2) * fresh[k]
    return NOISE * (np.sqrt(SLOW) * slow + np.sqrt(1.0 - SLOW) * rng.normal(size=slow.shape))
