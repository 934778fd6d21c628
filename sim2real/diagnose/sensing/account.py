"""What the sensing lacks, by all its recordings; and the recordings freed of it, for those who explain the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.apart import Launches
from sim2real.diagnose.contacts import Geometry, geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.finding import Account
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.proof import pooled
from sim2real.diagnose.sensing.clock import meetings
from sim2real.diagnose.sensing.clock_findings import ClockAccount, clock_account
from sim2real.diagnose.sensing.correct import corrected
from sim2real.diagnose.sensing.held import held_finding, repeats
from sim2real.diagnose.sensing.scale import ScaleAccount, scale_account
from sim2real.diagnose.strikes import Strike, strikes
from sim2real.recording import Recording


@dataclass(frozen=True)
class Sensed:
    """The account of the sensing, and the recordings and their pieces as an exact camera would have given them."""

    account: Account
    recordings: tuple[Recording, ...]
    pieces: tuple[Pieces, ...]


def sense(recordings: Sequence[Recording], pieces: Sequence[Pieces], launches: Launches) -> Sensed:
    """Explain the sensing of recordings of one table: the map first, then the clock, then the frames held.

    The launches kept apart are corrected as the others are, and tell nothing but the proof; but of recordings that are
    not held out all touches of the walls are asked for the map, for they are few: `_scale`.
    """
    recordings, pieces = list(recordings), list(pieces)
    found = _strikes(recordings, pieces, launches)
    calibrated = any(one.nominal("camera", "place_std_m") for one in recordings)
    scale = _scale(found, geometry(recordings[0]), launches, calibrated)
    if scale.findings:
        recordings = [corrected(one, scale.values) for one in recordings]
        pieces = [cut(one) for one in recordings]
        found = _strikes(recordings, pieces, launches)
    clock = _clock(recordings, found, launches.apart)
    counts = [repeats(*each) for each in zip(recordings, pieces, launches.of_row, strict=True)]
    held, held_proof = held_finding(counts, launches.apart)
    if clock.findings:
        recordings = [corrected(one, np.zeros(3), clock.clock) for one in recordings]
        pieces = [cut(one) for one in recordings]
    findings = sorted((*clock.findings, *scale.findings, *((held,) if held else ())), key=lambda one: one.p_value)
    proof = pooled([one for one in (clock.proof, scale.proof, held_proof) if one is not None])
    account = Account(
        "sensing", tuple(findings), {}, not findings, proof, scale.undetermined, _next(recordings, clock, scale)
    )
    return Sensed(account, tuple(recordings), tuple(pieces))


def _strikes(recordings: list[Recording], pieces: list[Pieces], launches: Launches) -> list[list[Strike]]:
    """The strikes of each recording with the numbers of their launches; none that leads from one that is kept apart
    into one that is not, or back."""
    found = []
    for one, part, of_row in zip(recordings, pieces, launches.of_row, strict=True):
        some = strikes(one, part)
        ends = of_row[np.array([s.hit.frames for s in some], int).reshape(-1, 2)]
        whole = np.ptp(launches.is_apart(ends).astype(int), axis=1) == 0
        found.append([replace(s, launch=int(end)) for s, end, use in zip(some, ends[:, 0], whole, strict=True) if use])
    return found


def _scale(found: list[list[Strike]], g: Geometry, launches: Launches, calibrated: bool) -> ScaleAccount:
    """The map by all recordings but those held out, proved on these or launch by launch; what is undone is, as far as
    they tell it, by the launches alone that are not kept apart."""
    every = [s for part in found for s in part]
    seen = [s for s in every if s.launch not in launches.apart]
    if launches.heldout:
        return scale_account(seen, g, [s for s in every if s.launch in launches.apart], calibrated)
    told = scale_account(every, g, calibrated=calibrated)
    values = scale_account(seen, g, calibrated=calibrated).values if told.findings else told.values
    return replace(told, values=np.where((values != 0.0) & (told.values != 0.0), values, told.values))


def _clock(recordings: list[Recording], found: list[list[Strike]], apart: np.ndarray) -> ClockAccount:
    tables = []
    for one, part in zip(recordings, found, strict=True):
        encoders = read_encoders(one)
        if encoders is not None and part:
            tables.append(meetings(part, encoders, geometry(one)))
    return clock_account(tables, apart)


def _next(recordings: list[Recording], clock: ClockAccount, scale: ScaleAccount) -> str:
    if scale.findings or scale.undetermined:
        return "measure the table's length and width: a wrong stated size looks like a stretched map"
    strikes_seen = any(one.mallet is not None for one in recordings)
    if not clock.told and strikes_seen and any(one.frames is not None and one.frames.rows for one in recordings):
        return "to see the camera's delay, record a minute in which the robot strikes the puck with a moving mallet"
    return ""
