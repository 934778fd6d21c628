"""The search for places, times and periods of the forces in `searched_forces` that explain most of the residuals.

A span is the difference of two steps, so the columns of some steps give the gain of every span between two of them. The
best of them is then refined by looking nearby.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import product
from typing import TypeVar

import numpy as np

from sim2real.diagnose.engine.linear.rest import Rest, gains_of_groups
from sim2real.diagnose.regimes.sliding.forces.motion import Columns, Motion, along_axes, scaled
from sim2real.diagnose.regimes.sliding.forces.searched_forces import COORDINATES, Span, Wave
from sim2real.diagnose.regimes.sliding.tuned import SLIDING

Shape = tuple[float, ...]
Force = TypeVar("Force", Span, Wave)
FREQUENCIES = np.arange(*map(float, SLIDING.wave_numbers)) / SLIDING.wave_span  # Hz, of waves in time


@dataclass(frozen=True)
class Found:
    """A force, the name that its variants share, and the number of shapes from which it was chosen."""

    force: Span | Wave
    variant_of: str
    searched: int


@dataclass(frozen=True)
class ForceSearch:
    """Searches along a `motion`. `columns`: maps forces to columns of the residuals; `rest`: residuals of the rows
    `used` (2n,) bool."""

    motion: Motion
    columns: Columns
    rest: Rest
    used: np.ndarray

    def spans(self, kind: str, of: str, steps: Steps) -> Iterator[Found]:
        """The best span of a coordinate `of` for a `kind` of force, if any explains much."""
        first, last = np.triu_indices(len(steps.at), 1)
        narrow = last - first < SLIDING.widest_span * len(steps.at)
        first, last = first[narrow], last[narrow]
        gains = steps.gains(self.rest, first, last)
        best = int(np.argmax(gains))
        if gains[best] < SLIDING.least_search_gain:
            return
        low, high = float(steps.at[first[best]]), float(steps.at[last[best]])

        def span(shape: Shape) -> Span:
            return Span(kind, of, round(min(shape), 4), round(max(*shape, min(shape) + 1e-3), 4))

        yield Found(self._refined(span, (low, high), (steps.gap, steps.gap)), f"{kind} in a span of {of}", len(first))

    def waves_and_pulses(self) -> Iterator[Found]:
        """The best wave in time, and the best pulses of about its period, if it explains much."""
        gains = self._gains([Wave(1.0 / f) for f in FREQUENCIES])
        if gains.max() < SLIDING.least_search_gain:
            return
        start = float(FREQUENCIES[np.argmax(gains)])

        def wave(shape: Shape) -> Wave:
            return Wave(round(1.0 / shape[0], 4))

        found = self._refined(wave, (start,), (0.5 / SLIDING.wave_span,))
        yield Found(found, "brake by a wave in time", len(gains))
        yield self._pulses(found.period)

    def _pulses(self, period: float) -> Found:
        """The best pulses of about a `period` [s]."""
        begins, shares = np.arange(SLIDING.pulse_begins) / SLIDING.pulse_begins, SLIDING.pulse_shares

        def pulse(shape: Shape) -> Span:
            begin, share, every = shape[0], min(max(shape[1], 0.05), 0.95), round(shape[2], 4)
            if share > 0.5:  # less friction outside is more inside
                begin, share = begin + share, 1.0 - share
            low = round((begin % 1.0) * every, 4)
            return Span("brake", "t", low, round(low + share * every, 4), every)

        shapes = [(float(begin), share, period) for begin in begins for share in shares]
        start = shapes[int(np.argmax(self._gains([pulse(shape) for shape in shapes])))]
        steps = (0.5 / len(begins), 0.1, 0.25 * period**2 / SLIDING.wave_span)
        return Found(self._refined(pulse, start, steps), "brake in pulses", len(shapes) * len(FREQUENCIES))

    def _refined(self, make: Callable[[Shape], Force], start: Shape, steps: Shape) -> Force:
        """The best force near a shape, of which each number is moved by its step, then by halves of that."""
        best = start
        for finer in range(SLIDING.span_refinements):
            moves = product(*[(-step * 0.5**finer, 0.0, step * 0.5**finer) for step in steps])
            near = [tuple(a + by for a, by in zip(best, move, strict=True)) for move in moves]
            best = near[int(np.argmax(self._gains([make(shape) for shape in near])))]
        return make(best)

    def _gains(self, forces: Sequence[Span | Wave]) -> np.ndarray:
        """The decrease (f,) of the sum of squares by each of the forces."""
        found = []
        for some in _parts(forces, SLIDING.patch_chunk):
            laws = [one.force(self.motion) for one in some]
            each = laws[0].shape[2]
            normal, right = self.rest.normal(self.columns(np.concatenate(laws, axis=2))[self.used])
            blocks = normal.reshape(len(some), each, len(some), each)[np.arange(len(some)), :, np.arange(len(some))]
            found.append(gains_of_groups(blocks, right.reshape(len(some), each)))
        return np.concatenate(found)


@dataclass(frozen=True)
class Steps:
    """The columns (m, q s) of q forces that begin `at` each of s + 1 places [s or m] of a coordinate and go on to its
    end; the last is that end."""

    at: np.ndarray
    columns: np.ndarray
    directions: int

    @classmethod
    def of(cls, motion: Motion, columns: Columns, used: np.ndarray, kind: str, of: str) -> Steps:
        """The steps of a coordinate `of` for a `kind` of force; they divide the `used` (2n,) bool rows evenly."""
        u = COORDINATES[of][2](motion)
        at = np.unique(np.quantile(u[used[::2]], np.linspace(0.0, 1.0, SLIDING.span_edges + 1)))
        at[-1] += 1e-3  # so that the last frame is inside
        vectors = along_axes(motion) if kind == "push" else (-motion.along,)
        steps = scaled((u[:, None] >= at[:-1]).astype(float), *vectors)
        return cls(at, columns(steps)[used], len(vectors))

    @property
    def gap(self) -> float:
        """Half of the median distance of neighbours."""
        return 0.5 * float(np.median(np.diff(self.at)))

    def gains(self, rest: Rest, first: np.ndarray, last: np.ndarray) -> np.ndarray:
        """The decrease (w,) of the sum of squares by each span from the step `first` (w,) to the step `last` (w,)."""
        normal, right = rest.normal(self.columns)
        q, s = self.directions, len(self.at) - 1
        g = np.zeros((q, s + 1, q, s + 1))  # a step at the end is none
        g[:, :s, :, :s] = normal.reshape(q, s, q, s)
        c = np.zeros((q, s + 1))
        c[:, :s] = right.reshape(q, s)
        w = g[:, first, :, first] - g[:, first, :, last] - g[:, last, :, first] + g[:, last, :, last]
        return gains_of_groups(w, (c[:, first] - c[:, last]).T)


def searched_forces(motion: Motion, columns: Columns, rests: Sequence[Rest], used: np.ndarray) -> Iterator[Found]:
    """The best force of every kind beside each of the `rests`, where any explains much."""
    searches = [ForceSearch(motion, columns, rest, used) for rest in rests]
    for kind, of in product(("brake", "push"), COORDINATES):
        steps = Steps.of(motion, columns, used, kind, of)
        for search in searches:
            yield from search.spans(kind, of, steps)
    for search in searches:
        yield from search.waves_and_pulses()


def _parts(forces: Sequence[Span | Wave], most: int) -> Iterator[Sequence[Span | Wave]]:
    for first in range(0, len(forces), most):
        yield forces[first : first + most]
