"""What the sensing lacks, by all its recordings; and recordings freed of it, for those who explain the rest."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.finding import Account
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.proof import pooled
from sim2real.diagnose.sensing.clock import Fit, Meetings, meetings
from sim2real.diagnose.sensing.clock import missed as missed_clock
from sim2real.diagnose.sensing.clock_findings import ClockAccount, clock_account
from sim2real.diagnose.sensing.correct import corrected
from sim2real.diagnose.sensing.held import held_finding, repeats
from sim2real.diagnose.sensing.held import missed as missed_held
from sim2real.diagnose.sensing.measured import Measured, measured
from sim2real.diagnose.sensing.scale import ScaleAccount, scale_account
from sim2real.diagnose.sensing.scale import missed as missed_map
from sim2real.diagnose.strikes import Strike, strikes
from sim2real.recording import Recording

Launch = Sequence[np.ndarray]  # for each recording, the number (frames,) of each row's launch


@dataclass(frozen=True)
class Sensed:
    """The account of the sensing, and the recordings and their pieces as an exact camera would have given them: by a
    map of the values `scale` (3,), and a `clock`, None where it is right."""

    account: Account
    recordings: tuple[Recording, ...]
    pieces: tuple[Pieces, ...]
    scale: np.ndarray
    clock: Fit | None

    def undone(self, recording: Recording) -> Recording:
        """Another recording by the same camera, as an exact one would have given it."""
        mapped = corrected(recording, self.scale) if self.scale.any() else recording
        return mapped if self.clock is None else corrected(mapped, np.zeros(3), self.clock.clock)


def sense(recordings: Sequence[Recording], pieces: Sequence[Pieces], launch: Launch) -> Sensed:
    """Explain the sensing of recordings of one table: the map first, then the clock, then the frames held."""
    recordings, pieces = list(recordings), list(pieces)
    found = _strikes(recordings, pieces, launch)
    calibrated = any(one.nominal("camera", "place_std_m") for one in recordings)
    scale = scale_account([s for part in found for s in part], geometry(recordings[0]), calibrated)
    if scale.findings:
        recordings = [corrected(one, scale.values) for one in recordings]
        pieces = [cut(one) for one in recordings]
        found = _strikes(recordings, pieces, launch)
    clock = clock_account(_meetings(recordings, found))
    held, held_selection = held_finding([repeats(*each) for each in zip(recordings, pieces, launch, strict=True)])
    if clock.fit is not None:
        recordings = [corrected(one, np.zeros(3), clock.clock) for one in recordings]
        pieces = [cut(one) for one in recordings]
    findings = sorted((*clock.findings, *scale.findings, *((held,) if held else ())), key=lambda one: one.p_value)
    selection = pooled([one for one in (clock.selection, scale.selection, held_selection) if one is not None])
    advice = _next(recordings, clock, scale)
    account = Account("sensing", tuple(findings), {}, not findings, selection, scale.undetermined, advice)
    return Sensed(account, tuple(recordings), tuple(pieces), scale.values, clock.fit)


def prove_sensing(sensed: Sensed, recordings: Sequence[Recording], launch: Launch) -> Account:
    """The account with what its findings come to in `recordings` that were no part of it."""
    g, pieces = geometry(recordings[0]), [cut(one) for one in recordings]
    found = _strikes(recordings, pieces, launch)
    tried = {"scale_error": measured(*missed_map([s for part in found for s in part], sensed.scale, g).T)}
    recordings = [corrected(one, sensed.scale) for one in recordings] if sensed.scale.any() else list(recordings)
    pieces = [cut(one) for one in recordings]
    met = [one for one in _meetings(recordings, _strikes(recordings, pieces, launch)) if len(one.t)]
    if sensed.clock is not None and met:
        tried |= dict.fromkeys(("camera_delay", "clock_drift"), measured(*missed_clock(met, sensed.clock)))
    tried["held_frames"] = missed_held([repeats(*each) for each in zip(recordings, pieces, launch, strict=True)])
    named = {one.mechanism: tried.get(one.mechanism) for one in sensed.account.findings}
    findings = tuple(_with(one, named[one.mechanism]) for one in sensed.account.findings)
    known = {id(one): one.proof for one in named.values() if one is not None}
    return replace(sensed.account, findings=findings, proof=pooled(list(known.values())))


def _with(finding, sizes: Measured | None):
    return finding if sizes is None else replace(finding, before=sizes.before, after=sizes.after)


def _strikes(recordings: Sequence[Recording], pieces: Sequence[Pieces], launch: Launch) -> list[list[Strike]]:
    """The strikes of each recording with the numbers of the launches that they end."""
    found = []
    for one, part, of_row in zip(recordings, pieces, launch, strict=True):
        found.append([replace(s, launch=int(of_row[s.hit.frames[0]])) for s in strikes(one, part)])
    return found


def _meetings(recordings: Sequence[Recording], found: Sequence[list[Strike]]) -> list[Meetings]:
    read = [(read_encoders(one) if part else None, one, part) for one, part in zip(recordings, found, strict=True)]
    return [meetings(part, encoders, geometry(one)) for encoders, one, part in read if encoders is not None]


def _next(recordings: list[Recording], clock: ClockAccount, scale: ScaleAccount) -> str:
    if scale.findings or scale.undetermined:
        return "measure the table's length and width: a wrong stated size looks like a stretched map"
    strikes_seen = any(one.mallet is not None for one in recordings)
    if not clock.told and strikes_seen and any(one.frames is not None and one.frames.rows for one in recordings):
        return "to see the camera's delay, record a minute in which the robot strikes the puck with a moving mallet"
    return ""
