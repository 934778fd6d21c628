"""The size of sensor errors in launches that were left out of the fit."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.result.result import Proof


@dataclass(frozen=True)
class HeldOutErrors:
    """Rms of errors as recorded, `before`, and as corrected, `after`, in units of the noise; `proof`: in metres."""

    before: float
    after: float
    proof: Proof


def held_out_errors(before: np.ndarray, after: np.ndarray, std: np.ndarray, launch: np.ndarray) -> HeldOutErrors | None:
    """The rms of errors (n,) [m] before and after correction, with standard deviations `std` (n,) [m].

    Only errors that are finite in both, and whose standard deviation is, are used. `launch` (n,): the launch of each
    error, the unit of the proof. None if no error is.
    """
    both = np.isfinite(before) & np.isfinite(after) & np.isfinite(std)
    if not both.any():
        return None
    before, after, std = before[both], after[both], std[both]
    proof = Proof(rms(before), rms(after), rms(std), len(np.unique(launch[both])))
    return HeldOutErrors(rms(before / std), rms(after / std), proof)


def rms(of: np.ndarray) -> float:
    """The root of the mean square of numbers (n,)."""
    return float(np.sqrt(np.mean(of**2)))
