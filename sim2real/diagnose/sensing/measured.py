"""What the sensing's errors come to in launches that no fit saw."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.finding import Proof

SURE = 1e-5  # chance that the sensors have no such error, below which one is told


@dataclass(frozen=True)
class Measured:
    """Rms of errors as recorded (before) and as corrected (after), in units of the noise; and in metres, as `proof`."""

    before: float
    after: float
    proof: Proof


def measured(before: np.ndarray, after: np.ndarray, std: np.ndarray, launch: np.ndarray) -> Measured | None:
    """Of errors (n,) [m] with their standard deviations `std`, those known both ways; None where there are none.

    `launch` (n,): the launch of each; these are the pieces of the proof.
    """
    both = np.isfinite(before) & np.isfinite(after)
    if not both.any():
        return None
    before, after, std = before[both], after[both], std[both]
    proof = Proof(rms(before), rms(after), rms(std), len(np.unique(launch[both])))
    return Measured(rms(before / std), rms(after / std), proof)


def rms(of: np.ndarray) -> float:
    """The root of the mean square."""
    return float(np.sqrt(np.mean(of**2)))
