"""Check that recordings are of one table and one camera, by places and times of contacts with walls and mallet."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import combinations

import numpy as np

from sim2real.diagnose.input_checks import UndeterminedError, two_tables
from sim2real.diagnose.regimes.sensing.clock import ClockFit, TimedContacts, fit_clock, search_clock, timed_contacts
from sim2real.diagnose.regimes.sensing.coordinate_scale import NAMES, fitted_map, wrong_size
from sim2real.diagnose.regimes.sensing.tuned import CONSISTENCY, SCALE
from sim2real.recording.folder import Recording
from sim2real.segmentation.causes import geometry
from sim2real.segmentation.mallet_path import robot_path
from sim2real.segmentation.segments import Segments
from sim2real.segmentation.velocity_jumps import velocity_jumps


def check_sensing(recordings: Sequence[Recording], segments: Sequence[Segments]) -> None:
    """Raise `UndeterminedError` if the walls' contact lines or the camera's delays differ between recordings."""
    if len(recordings) < 2:
        return
    names = [one.name for one in recordings]
    found = [velocity_jumps(one, part) for one, part in zip(recordings, segments, strict=True)]
    scales, std = np.zeros((2, len(names), len(NAMES)))
    for k, one in enumerate(recordings):
        g = geometry(one)
        scales[k], covariance = fitted_map(found[k], g)
        std[k] = np.sqrt(np.diag(covariance))
        wrong = wrong_size(scales[k], std[k], g)
        if wrong:
            raise UndeterminedError(f"in {one.name}, {wrong}", "measure the table's length and width")
    _check_map(names, scales, std)
    mallet_contacts = []
    for one, part in zip(recordings, found, strict=True):
        encoders = robot_path(one) if part else None
        mallet_contacts.append(None if encoders is None else timed_contacts(part, encoders, geometry(one)))
    _check_clock(names, mallet_contacts)


def _check_map(names: Sequence[str], scales: np.ndarray, std: np.ndarray) -> None:
    """Compare the maps of n recordings: `scales` (n, 3), in the order of NAMES, with their errors `std` (n, 3)."""
    for one, other in combinations(range(len(names)), 2):
        difference = np.abs(scales[one] - scales[other])
        known = np.maximum(std[one], std[other]) < SCALE.known
        error = CONSISTENCY.significance * np.hypot(std[one], std[other])
        significant = known & (difference > np.maximum(CONSISTENCY.largest_scale, error))
        if significant.any():
            why = f"the places where the puck bounces differ by {difference[significant].max():.1%}"
            raise two_tables(names[one], names[other], why)


def _check_clock(names: Sequence[str], mallet_contacts: Sequence[TimedContacts | None]) -> None:
    """Compare the clocks of recordings by their contacts with the robot's mallet; None if encoders are missing."""
    fits = [
        (name, some, each) for name, some in zip(names, mallet_contacts, strict=True) if some and (each := _clock(some))
    ]
    for (one, some, here), (other, more, there) in combinations(fits, 2):
        a, b = here.clock, there.clock
        difference = np.array([a.delay - b.delay, a.rate - b.rate])
        late = float(difference @ (1.0, 0.5 * min(some.t[-1], more.t[-1])))
        weight = np.linalg.pinv(a.covariance + b.covariance, hermitian=True)
        significant = difference @ weight @ difference > CONSISTENCY.significance**2
        if significant and abs(late) > CONSISTENCY.largest_delay:
            raise two_tables(one, other, f"the camera's delays differ by {1e3 * abs(late):.0f} ms")


def _clock(some: TimedContacts) -> ClockFit | None:
    """Fit the clock of one recording alone; None if its contacts do not determine it."""
    found = fit_clock([some], search_clock([some]), (True, True)) if len(some.t) > CONSISTENCY.fewest_free else None
    return found if found is not None and found.freedom >= CONSISTENCY.fewest_free else None
