"""Play tables at the ends of their ranges against players that press, and hold every step against the laws.

A batch is all that an id and a seed say: `play_batch(id, seed)` is the same each time, so what it finds can be found
again. Every table is stepped by itself, so that a step which takes long is known by table; it is stepped again from the
same state before it counts as slow, since a machine may have been busy.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from time import perf_counter_ns

import numpy as np
from numpy.typing import NDArray

from puckpilot_env.batch import kernels
from puckpilot_env.checks.adversarial import adversaries, extremes, invariants
from puckpilot_env.tables import Tables

TABLES, STEPS = 128, 128  # of a batch
STEPS_OF_A_BATCH = TABLES * STEPS
REPLANT = 16  # steps after which pucks are put in hard places again
MOST_MEDIANS = 200.0  # that the slowest step may take; 141 in ten million steps
SUSPECT = 20.0  # times the batch's median: such a step is timed again
REPEATS = 5
PIECES = 50.0  # steps that one of mallets which go piece by piece may take as long as
BINS, BINS_OF_DOUBLE = 800, 20  # of a histogram of times: bin k begins at 2^(k / BINS_OF_DOUBLE) ns


@dataclass(frozen=True)
class Place:
    """A step of a table."""

    id: str
    seed: int
    table: int
    step: int
    numbers: str  # of the table, that are not the defaults

    def __str__(self) -> str:
        command = f"puckpilot check --adversarial 1 --seed {self.seed} {self.id}"
        return f"table {self.table}, step {self.step} of {command}\n  {self.numbers}"


@dataclass(frozen=True)
class Breach:
    """A law that a table broke."""

    what: str
    place: Place

    def __str__(self) -> str:
        return f"{self.what}: {self.place}"


@dataclass(frozen=True)
class Slowest:
    """The step that took longest."""

    seconds: float = 0.0
    place: Place | None = None

    def __str__(self) -> str:
        return str(self.place)


@dataclass
class Found:
    """What batches brought."""

    steps: int = 0
    breaches: list[Breach] = field(default_factory=list)
    times: NDArray[np.int64] = field(default_factory=lambda: np.zeros(BINS, np.int64))  # histogram
    slowest: Slowest = field(default_factory=Slowest)

    def add(self, other: Found) -> None:
        """Take in what another batch brought."""
        self.steps += other.steps
        self.breaches += other.breaches
        self.times += other.times
        self.slowest = max(self.slowest, other.slowest, key=lambda s: s.seconds)

    @property
    def median(self) -> float:
        """Of all steps' times [s], to a bin."""
        total = int(self.times.sum())
        middle = int(np.searchsorted(np.cumsum(self.times), 0.5 * total))
        return 2.0 ** ((middle + 0.5) / BINS_OF_DOUBLE) * 1e-9 if total else float("nan")


def no_note(step: int, table: int) -> None:
    """Tell nobody."""


class _Stepper:
    """Steps the tables of a batch one by one, and times each."""

    def __init__(self, tables: Tables) -> None:
        self.tables = tables
        self.log, films = kernels.scratch(1)
        self.film = films[0]
        self.overhead = min(self._time(tables._arrays(self._no_actions()), 0, 0) for _ in range(20))

    def _no_actions(self) -> NDArray[np.float32]:
        return np.zeros((len(self.tables), 2, 4), np.float32)

    def _time(self, arrays: tuple, first: int, last: int) -> int:
        begin = perf_counter_ns()
        kernels.step_range(*arrays, self.log, self.film, first, last)
        return perf_counter_ns() - begin

    def step(
        self, actions: NDArray[np.float32], out: NDArray[np.bool_], note: Callable[[int], None]
    ) -> NDArray[np.int64]:
        """(n,) nanoseconds of each table's step, 0 for the tables that are `out` of the game."""
        arrays = self.tables._arrays(actions)
        taken = np.zeros(len(self.tables), np.int64)
        for i in np.flatnonzero(~out).tolist():
            note(i)
            taken[i] = max(self._time(arrays, i, i + 1) - self.overhead, 1)
        return taken

    def again(self, kept: list[NDArray[np.uint8]], actions: NDArray[np.float32], i: int) -> int:
        """The shortest time of the same step of table `i`, from the numbers `kept` before it. It ends as it did."""
        arrays, best = self.tables._arrays(actions), 1 << 62
        for _ in range(REPEATS):
            for array, old in zip(self._arrays(), kept, strict=True):
                array[i] = old[i]
            best = min(best, self._time(arrays, i, i + 1) - self.overhead)
        return best

    def _arrays(self) -> list[NDArray[np.uint8]]:
        tables = self.tables
        records = (tables.states, tables._frames, tables.params)
        return [array.view(np.uint8).reshape(len(tables), -1) for array in records]

    def kept(self) -> list[NDArray[np.uint8]]:
        """What a step changes and depends on, to begin it again."""
        return [array.copy() for array in self._arrays()]


def play_batch(name: str, seed: int, note: Callable[[int, int], None] = no_note) -> Found:
    """Play the batch of an id and a seed; `note` is called with step and table before each step."""
    tables, rng = extremes.draw_tables(name, TABLES, seed)
    stepper, found = _Stepper(tables), Found()
    styles = adversaries.choose(TABLES, rng)
    blank = rng.random() < 0.5  # touches are forgotten, so that more steps can be held to their energy
    out = np.zeros(TABLES, np.bool_)
    short = max(tables.variant.period / 0.1, 1.0)  # a step of a second may take ten times that of a tenth
    for step in range(STEPS):
        if step % REPLANT == 0:
            adversaries.plant(tables, 0.5, rng)
        if blank:
            tables.states["puck"]["touched"] = 0
        before, kept = invariants.Before(tables), stepper.kept()
        actions = adversaries.act(tables, styles, step, rng)
        taken = stepper.step(actions, out, lambda i, step=step: note(step, i))
        worth = short * np.where(tables.states["in_pieces"] == 1, PIECES, 1.0)
        taken = taken / worth
        usual = SUSPECT * float(np.median(taken[~out])) if not out.all() else 0.0
        for i in np.flatnonzero(taken > max(usual, 1e9 * found.slowest.seconds)).tolist():
            taken[i] = min(taken[i], stepper.again(kept, actions, i) / worth[i])
        bins = np.clip(BINS_OF_DOUBLE * np.log2(np.maximum(taken[~out], 1.0)), 0, BINS - 1).astype(np.int64)
        np.add.at(found.times, bins, 1)
        found.steps += int((~out).sum())
        i = int(np.argmax(taken))
        if 1e-9 * taken[i] > found.slowest.seconds:
            found.slowest = Slowest(1e-9 * float(taken[i]), Place(name, seed, i, step, extremes.described(tables, i)))
        _judge(tables, before, found, out, (name, seed, step))
    return found


def _judge(tables: Tables, before: invariants.Before, found: Found, out: NDArray, at: tuple[str, int, int]) -> None:
    """Note what each table broke first; from then on it is `out` of the game."""
    name, seed, step = at
    for where, what, amount in invariants.broken(tables, before):
        for i in np.flatnonzero(where & ~out).tolist():
            words = what if np.isnan(amount[i]) else f"{what} {amount[i]:.3g}"
            found.breaches.append(Breach(words, Place(name, seed, i, step, extremes.described(tables, i))))
            out[i] = True
