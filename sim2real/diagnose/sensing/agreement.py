"""Whether recordings of one call are of one table and one camera: by where and when the puck meets walls and mallet."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.pieces import Pieces
from sim2real.diagnose.sanity import UndeterminedError, two_tables
from sim2real.diagnose.sensing.clock import Fit, Meetings, fit, meetings, search
from sim2real.diagnose.sensing.scale import KNOWN, NAMES, fitted_map, wrong_size
from sim2real.diagnose.strikes import strikes
from sim2real.recording import Recording

SIZE_APART = 0.01  # of a table's size
CLOCK_APART = 0.002  # s
SURE = 5.0  # standard deviations
FEWEST_FREE = 5  # blows beyond what a clock is fitted to


def check_sensing(recordings: Sequence[Recording], pieces: Sequence[Pieces]) -> None:
    """Raise `UndeterminedError` if the puck turns round in other places in one recording than in another, or if the
    camera is late by more in one than in another."""
    if len(recordings) < 2:
        return
    names = [one.name for one in recordings]
    found = [strikes(one, part) for one, part in zip(recordings, pieces, strict=True)]
    seen, std = np.zeros((2, len(names), len(NAMES)))
    for k, one in enumerate(recordings):
        g = geometry(one)
        seen[k], covariance = fitted_map(found[k], g)
        std[k] = np.sqrt(np.diag(covariance))
        wrong = wrong_size(seen[k], std[k], g)
        if wrong:
            raise UndeterminedError(f"in {one.name}, {wrong}", "measure the table's length and width")
    _same_map(names, seen, std)
    blows = []
    for one, part in zip(recordings, found, strict=True):
        encoders = read_encoders(one) if part else None
        blows.append(None if encoders is None else meetings(part, encoders, geometry(one)))
    _same_clock(names, blows)


def _same_map(names: Sequence[str], seen: np.ndarray, std: np.ndarray) -> None:
    """`seen`, `std` (n, 3): what each of `n` recordings says of the map, as in `scale.NAMES`."""
    for one, other in combinations(range(len(names)), 2):
        apart = np.abs(seen[one] - seen[other])
        told = np.maximum(std[one], std[other]) < KNOWN
        sure = told & (apart > np.maximum(SIZE_APART, SURE * np.hypot(std[one], std[other])))
        if sure.any():
            why = f"the places where the puck turns round differ by {apart[sure].max():.1%}"
            raise two_tables(names[one], names[other], why)


def _same_clock(names: Sequence[str], blows: Sequence[Meetings | None]) -> None:
    """`blows`: what may be blows of the robot's mallet in each recording; None where no encoders tell."""
    fits = [(name, some, each) for name, some in zip(names, blows, strict=True) if some and (each := _clock(some))]
    for (one, some, here), (other, more, there) in combinations(fits, 2):
        a, b = here.clock, there.clock
        apart = np.array([a.delay - b.delay, a.rate - b.rate])
        late = float(apart @ (1.0, 0.5 * min(some.t[-1], more.t[-1])))
        sure = apart @ np.linalg.pinv(a.covariance + b.covariance, hermitian=True) @ apart > SURE**2
        if sure and abs(late) > CLOCK_APART:
            raise two_tables(
                one, other, f"the camera is later by {1e3 * abs(late):.0f} ms in the one than in the other"
            )


def _clock(some: Meetings) -> Fit | None:
    """The clock of one recording alone; None where it cannot be told."""
    found = fit([some], search([some]), (True, True)) if len(some.t) > FEWEST_FREE else None
    return found if found is not None and found.freedom >= FEWEST_FREE else None
