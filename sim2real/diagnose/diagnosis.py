"""Recordings in, a diagnosis out: each regime explain_regime in turn, the glides first, since hits are told by them."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim2real.diagnose.agreement import Part, parts_of
from sim2real.diagnose.apart import KEPT_APART, Launches, glides_of, keep_apart
from sim2real.diagnose.contact_data import join as join_contacts
from sim2real.diagnose.contact_data import known_apart
from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.fit import given
from sim2real.diagnose.explaining import explain_regime, too_little
from sim2real.diagnose.finding import MUCH, TO_THE_NOISE, Account, Finding, Proof, Sight
from sim2real.diagnose.gantry.problem import gantry_problem
from sim2real.diagnose.gantry.run import UnusableError
from sim2real.diagnose.glide.data import GlideData, join
from sim2real.diagnose.glide.problem import GlideProblem, States
from sim2real.diagnose.impacts import Impact, find_impacts
from sim2real.diagnose.mallet.data import Blows, blows
from sim2real.diagnose.mallet.problem import MalletProblem
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.proof import pooled
from sim2real.diagnose.sanity import UndeterminedError, check_usable, notes
from sim2real.diagnose.sensing.account import sense
from sim2real.diagnose.sensing.agreement import check_sensing
from sim2real.diagnose.sight import sight
from sim2real.diagnose.stated import together
from sim2real.diagnose.stretch import without_stretch
from sim2real.diagnose.wall.data import bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.nominal import parameters, stated_sizes
from sim2real.recording import Recording

Progress = Callable[[str, float], None]
CLOSED = "nothing further is needed to name what was recorded; record again to see whether it lasts"
OPEN = "no single recording is known to settle what is open: more launches all over the table, slow and fast, tell more"


@dataclass(frozen=True)
class Diagnosis:
    """All accounts, by regime. `reason`: why nothing can be said, "" if something can; `remedy`: what to do then.

    `notes`: what should be known of the recordings, a sentence each; `sights`: the sensor of each, those held out last;
    `sizes`: of the table, puck, mallet and gantry as far as they are stated, by the simulator's names.
    """

    accounts: tuple[Account, ...]
    reason: str = ""
    remedy: str = ""
    notes: tuple[str, ...] = ()
    sights: tuple[Sight, ...] = ()
    sizes: Mapping[str, float] = field(default_factory=dict)

    @property
    def findings(self) -> list[Finding]:
        """All findings, strongest first."""
        every = [one for each in self.accounts for one in each.findings]
        return sorted(every, key=lambda one: (one.p_value, -one.before))

    @property
    def verdict(self) -> str:
        """agrees, parameters_only, missing_physics or undetermined."""
        if self.findings:
            return "missing_physics"
        told = [each for each in self.accounts if each.regime != "sensing" and not each.undetermined]
        if self.reason or not told or any(each.lost for each in self.accounts):
            return "undetermined"
        return "agrees" if all(each.shipped for each in told) else "parameters_only"

    @property
    def next_recording(self) -> str:
        """What to record next, in one sentence."""
        return next(iter(self.advice), OPEN if self.is_open else CLOSED)

    @property
    def advice(self) -> list[str]:
        """What could be recorded to settle what is open, as far as that is known."""
        return [one for one in (self.remedy, *(each.next_recording for each in self.accounts)) if one]

    @property
    def is_open(self) -> bool:
        """Whether anything is left to settle."""
        left = any((each.times_noise or 0.0) > TO_THE_NOISE or each.doubt for each in self.accounts)
        return bool(self.verdict == "undetermined" or self.advice or left)

    @property
    def untold(self) -> list[Account]:
        """The regimes of which nothing can be said."""
        return [each for each in self.accounts if each.undetermined]

    @property
    def remarks(self) -> list[str]:
        """What should be known beside the verdict, a sentence each."""
        untold = [f"{each.regime}: undetermined, {each.undetermined}{_missed_by(each)}" for each in self.untold]
        doubts = [f"{each.regime}: {each.doubt}" for each in self.accounts if each.doubt]
        left = [f"{each.regime}: {each.unexplained}" for each in self.accounts if each.unexplained]
        return [*self.notes, *untold, *doubts, *left]

    @property
    def proof(self) -> Proof | None:
        """Held-out residuals over the regimes with findings, or over all where there are none."""
        lacking = [each for each in self.accounts if each.findings] or self.accounts
        return pooled([each.proof for each in lacking if each.proof is not None])


def _missed_by(each: Account) -> str:
    """By how much untouched launches are missed, where that is worth a word."""
    many = each.times_noise
    return f"; what is refitted misses untouched launches by {many:.2g} times the noise" if many and many > MUCH else ""


@dataclass(frozen=True)
class Cut:
    """Recordings of one table, cut up. `heldout`: how many of the last ones serve the proof alone; `launches` of all
    that do."""

    recordings: Sequence[Recording]
    pieces: Sequence[Pieces]
    heldout: int
    launches: Launches


def diagnose(
    recordings: Sequence[Recording], heldout: Sequence[Recording], shipped: Mapping[str, float], progress: Progress
) -> Diagnosis:
    """Explain `recordings`, and prove it on `heldout` or, where there are none, on launches kept apart.

    ValueError, in one line, for recordings that state different tables.
    """
    every = together([*recordings, *heldout], shipped)
    try:
        check_usable(every)
        timed = [one.from_zero() for one in every]
        accounts, sights = _accounts(timed[: len(recordings)], timed[len(recordings) :], shipped, progress)
    except UndeterminedError as why:
        return Diagnosis((), why.reason, why.remedy, notes(every))
    return Diagnosis(accounts, notes=notes(every), sights=sights, sizes=stated_sizes(every[0]))


def _accounts(
    recordings: Sequence[Recording], heldout: Sequence[Recording], shipped: Mapping[str, float], progress: Progress
) -> tuple[tuple[Account, ...], tuple[Sight, ...]]:
    """What each regime says, and the sensor of each recording."""
    progress("cutting", 0.0)
    every = [*recordings, *heldout]
    pieces = [cut(one) for one in every]
    check_sensing(every, pieces)
    progress("sensing", 0.1)
    launches = keep_apart(every, pieces, len(heldout))
    sensed = sense(every, pieces, launches)
    if sensed.account.undetermined:
        raise UndeterminedError(sensed.account.undetermined, sensed.account.next_recording)
    data = Cut(sensed.recordings, sensed.pieces, len(heldout), launches)
    values = parameters(recordings[0], shipped)
    parts = [glides_of(one, pieces) for one, pieces in zip(data.recordings, data.pieces, strict=True)]
    sights = tuple(sight(*one) for one in zip(data.recordings, data.pieces, parts, strict=True))
    gantry = _gantry(data, values, progress)
    puck = _puck(data, parts, sights, values, progress)
    return (sensed.account, *(without_stretch(each, sensed.account) for each in puck), *gantry), sights


def _puck(
    data: Cut, parts: Sequence[GlideData], sights: Sequence[Sight], values: dict[str, float], progress: Progress
) -> Iterator[Account]:
    """Accounts of the puck's regimes, in the order in which one leans on the other: hits are told by the glides. None
    where no puck was seen."""
    if not any(seen.frames and seen.dropped < 1.0 for seen in sights):
        return
    progress("glides", 0.2)
    if not sum(part.glides for part in parts):
        yield too_little("glide")
        return
    proof = data.launches.clusters_apart(data.recordings, parts)
    glides = GlideProblem(join(parts), values, proof)
    tables = parts_of(glides.data, [one.name for one in data.recordings])
    law = dict(values)
    found, told, clear = explain_regime(glides, law, proof, tables)
    yield told
    states = glides.states(given(law)) if found is None else _states(glides, found)
    law |= {} if found is None else found.final.values
    rests_on = (clear, clear and not told.lost)
    progress("bounces", 0.6)
    impacts = [find_impacts(pieces, glides, states, k) for k, pieces in enumerate(data.pieces)]
    hits = known_apart(bounces([hit for some in impacts for hit in some], geometry(data.recordings[0]), proof), proof)
    yield explain_regime(WallProblem(hits, glides.clusters, law), law, proof, tables, *rests_on)[1]
    progress("blows", 0.75)
    struck = _blows(data.recordings, impacts)
    if struck is not None:
        struck = known_apart(struck, proof)
        yield explain_regime(MalletProblem(struck, glides.clusters, law), law, proof, tables, *rests_on)[1]


def _gantry(data: Cut, values: dict[str, float], progress: Progress) -> list[Account]:
    """The account of the gantry; none where its path was not recorded."""
    if all(one.mallet is None for one in data.recordings):
        return []
    progress("gantry", 0.2)
    touched = [np.array([hit.t for hit in part.hits if hit.where == "robot"]) for part in data.pieces]
    try:
        problem, runs = gantry_problem(data.recordings, values, touched)
    except UnusableError as why:
        return [Account("gantry", (), {}, False, None, str(why))]
    apart = sum(k >= len(data.recordings) - data.heldout for k in runs)
    if apart == len(runs):
        return [too_little("gantry")]
    problem = problem.proved_on(apart, KEPT_APART).ticked()
    tables = [Part(data.recordings[k].name, part) for k, part in zip(runs, problem.clusters_of_runs, strict=True)]
    alone = not any(len(times) for times in touched)
    return [explain_regime(problem, values, problem.proof, tables, alone, alone)[1]]


def _states(glides: GlideProblem, found: Explained) -> States:
    if found.unlisted is None or found.switched():
        return glides.states(replace(found.final, values=found.mended))
    return glides.states(found.final, found.unlisted.name, found.coefficients)


def _blows(recordings: Sequence[Recording], impacts: Sequence[list[Impact]]) -> Blows | None:
    """The blows of the robot's mallet in all recordings that know where it was; None where there are none."""
    read = [(read_encoders(one), geometry(one), some) for one, some in zip(recordings, impacts, strict=True)]
    parts = [blows(some, encoders, g) for encoders, g, some in read if encoders is not None]
    parts = [part for part in parts if len(part)]
    return join_contacts(parts) if parts else None
