"""What the sensing lacks, by all its recordings; and the recordings freed of it, for those who explain the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.finding import Account
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.sensing.clock import EXACT, Clock, meetings
from sim2real.diagnose.sensing.clock_findings import ClockAccount, clock_account
from sim2real.diagnose.sensing.correct import corrected
from sim2real.diagnose.sensing.held import held_finding, repeats
from sim2real.diagnose.sensing.scale import ScaleAccount, scale_account
from sim2real.diagnose.strikes import MANY_LAUNCHES, Strike, strikes
from sim2real.recording import Recording


@dataclass(frozen=True)
class Sensed:
    """The account of the sensing, and the recordings and their pieces as an exact camera would have given them.

    `scale`, `clock`: what was undone.
    """

    account: Account
    recordings: tuple[Recording, ...]
    pieces: tuple[Pieces, ...]
    scale: np.ndarray
    clock: Clock

    def exact(self, recording: Recording) -> Recording:
        """Another recording of the same camera as an exact one would have given it."""
        return corrected(recording, self.scale, self.clock)


def sense(recordings: Sequence[Recording], pieces: Sequence[Pieces]) -> Sensed:
    """Explain the sensing of recordings of one table: the map first, then the clock, then the frames held."""
    recordings, pieces = list(recordings), list(pieces)
    found = [strikes(one, part) for one, part in zip(recordings, pieces, strict=True)]
    scale = scale_account(_joined(found), geometry(recordings[0]))
    if scale.findings:
        recordings = [corrected(one, scale.values) for one in recordings]
        pieces = [cut(one) for one in recordings]
        found = [strikes(one, part) for one, part in zip(recordings, pieces, strict=True)]
    clock = _clock(recordings, found)
    held, held_proof = held_finding([repeats(one, part) for one, part in zip(recordings, pieces, strict=True)])
    if clock.findings:
        recordings = [corrected(one, np.zeros(3), clock.clock) for one in recordings]
        pieces = [cut(one) for one in recordings]
    findings = sorted((*clock.findings, *scale.findings, *((held,) if held else ())), key=lambda one: one.p_value)
    proof = clock.proof or scale.proof or held_proof
    account = Account(
        "sensing", tuple(findings), {}, not findings, proof, scale.undetermined, _next(recordings, clock, scale)
    )
    return Sensed(account, tuple(recordings), tuple(pieces), scale.values, clock.clock)


def _joined(found: list[list[Strike]]) -> list[Strike]:
    """The strikes of all recordings, their launches told apart."""
    return [
        Strike(s.hit, s.state, s.covariance, s.launch + MANY_LAUNCHES * k) for k, part in enumerate(found) for s in part
    ]


def _clock(recordings: list[Recording], found: list[list[Strike]]) -> ClockAccount:
    tables = []
    for one, part in zip(recordings, found, strict=True):
        encoders = read_encoders(one)
        if encoders is not None and part:
            tables.append(meetings(part, encoders, geometry(one)))
    return clock_account(tables) if tables else ClockAccount(EXACT, (), None, False)


def _next(recordings: list[Recording], clock: ClockAccount, scale: ScaleAccount) -> str:
    if scale.findings or scale.undetermined:
        return "measure the table's length and width: a wrong stated size looks like a stretched map"
    strikes_seen = any(one.mallet is not None for one in recordings)
    if not clock.told and strikes_seen and any(one.frames is not None and one.frames.rows for one in recordings):
        return "to see the camera's delay, record a minute in which the robot strikes the puck with a moving mallet"
    return ""
