"""Checks of the recordings before a diagnosis: each failure is a reason to name nothing, with a remedy."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from sim2real.diagnose.report.plain_words import counted
from sim2real.diagnose.tuned import INPUT
from sim2real.recording.folder import POSITIONS, Recording, Stream
from sim2real.recording.stated import assumptions
from sim2real.segmentation.clock_jumps import clock_jumps


class UndeterminedError(Exception):
    """Recordings that allow no conclusion: the `reason` in one clause, and the `remedy` in one sentence."""

    def __init__(self, reason: str, remedy: str) -> None:
        super().__init__(reason)
        self.reason, self.remedy = reason, remedy


def two_tables(one: str, other: str, why: str) -> UndeterminedError:
    """Return the error for two recordings, by name, that cannot be of one table; `why`: how they differ."""
    return UndeterminedError(f"{one} and {other} are not of one table: {why}", "diagnose each recording separately")


def check_usable(recordings: Sequence[Recording]) -> None:
    """Raise `UndeterminedError` for recordings that are too short, without motion, cut off, or with clock jumps."""
    seconds = sum(_seconds(one) for one in recordings)
    if seconds < INPUT.least_seconds:
        raise UndeterminedError(
            f"too little data: {seconds:.1f} s in total", "record at least one minute without a pause"
        )
    if all(_still(one) for one in recordings):
        raise UndeterminedError("the puck never moves", "launch the puck about twenty times, in all directions")
    for one in recordings:
        for check in (_cut_off, _clock_jumping, _paused):
            for reason, remedy in check(one):
                raise UndeterminedError(f"in {one.name}, {reason}", remedy)


def notes(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return remarks on the recordings, a sentence each: `stream_notes`, and values that none of them states."""
    return (*stream_notes(recordings), *assumptions(recordings))


def stream_notes(recordings: Sequence[Recording]) -> tuple[str, ...]:
    """Return remarks on the recordings' streams, a sentence each: outliers, and pauses at which they were cut."""
    found = [f"{one.name}: {note}" for one in recordings for note in one.notes]
    for one in recordings:
        for name, stream in _rows(one).items():
            pauses = int((np.diff(stream.t) > INPUT.pause).sum()) if name in POSITIONS else 0
            if pauses:
                many = counted(pauses, "pause", "pauses")
                found.append(f"{one.name}: {name}.csv has {many} of more than {INPUT.pause:g} s and is cut there")
    return tuple(found)


def _rows(one: Recording) -> dict[str, Stream]:
    return {name: stream for name, stream in one.streams().items() if stream.rows}


def _seconds(one: Recording) -> float:
    return max((float(np.ptp(stream.t)) for stream in _rows(one).values()), default=0.0)


def _still(one: Recording) -> bool:
    """Return whether a recording without a mallet shows no puck, or a puck that rests."""
    streams = _rows(one)
    if "mallet" in streams:
        return False
    if "frames" not in streams:
        return True
    place = _place(streams["frames"], "frames")
    place = place[np.isfinite(place).all(axis=1)]
    return not len(place) or bool(np.all(np.ptp(np.quantile(place, (0.02, 0.98), axis=0), axis=0) < INPUT.still))


def _place(stream: Stream, name: str) -> np.ndarray:
    return np.stack([stream[column] for column in POSITIONS[name]], axis=1)


def _cut_off(one: Recording) -> Iterator[tuple[str, str]]:
    """Yield streams that end long before the others; commands may end once the mallet rests."""
    streams = _rows(one)
    ends = {name: float(stream.t[-1]) for name, stream in streams.items()}
    if "commands" in ends and _rests_after(streams.get("mallet"), ends["commands"] + INPUT.stops_by):
        del ends["commands"]
    last = max(ends, key=lambda name: ends[name])
    for name, end in ends.items():
        if ends[last] - end > max(INPUT.stops_by, INPUT.stops_early * _seconds(one)):
            yield (
                f"{name}.csv stops at {end:.1f} s while {last}.csv goes on to {ends[last]:.1f} s",
                f"find out why {name}.csv stops, or cut all streams of the recording at {end:.1f} s",
            )


def _rests_after(mallet: Stream | None, t: float) -> bool:
    """Return whether no mallet moves after the time `t` [s]."""
    if mallet is None:
        return True
    place = _place(mallet, "mallet")[mallet.t > t]
    return not len(place) or bool(np.all(np.nan_to_num(np.ptp(place, axis=0)) < INPUT.still))


def _clock_jumping(one: Recording) -> Iterator[tuple[str, str]]:
    """Yield clocks that jump while the recorded motion continues steadily."""
    for name, stream in _rows(one).items():
        if name not in POSITIONS:
            continue
        found = clock_jumps(stream.t, _place(stream, name))
        if found:
            more = f", one of {len(found)} jumps" if len(found) > 1 else ""
            yield (
                f"the clock of {name}.csv jumps by {1e3 * found[0].size:.0f} ms at {found[0].t:.2f} s{more}",
                f"record with a steady clock, or cut {name}.csv at the jump",
            )


def _paused(one: Recording) -> Iterator[tuple[str, str]]:
    """Yield streams with a gap in which others have rows: their clock may have jumped."""
    streams = {name: stream for name, stream in _rows(one).items() if name != "commands"}
    for name, stream in streams.items():
        others = [other.t for other in streams.values() if other is not stream]
        for at in np.flatnonzero(np.diff(stream.t) > INPUT.pause):
            begin, end = stream.t[at : at + 2]
            if any(((begin + INPUT.pause_edge < t) & (t < end - INPUT.pause_edge)).any() for t in others):
                yield (
                    f"{name}.csv has no row for {end - begin:.1f} s from {begin:.1f} s: it paused, or its clock jumped",
                    f"cut the recording at {begin:.1f} s into two",
                )
