"""What recordings lack, regime by regime, the glides first, since contacts are known by them. Of the data that prove it
nothing is seen here."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from sim2real.diagnose.agreement import Part, parts_of
from sim2real.diagnose.contact_data import join as join_contacts
from sim2real.diagnose.contacts import geometry
from sim2real.diagnose.encoders import read_encoders
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.fit import given
from sim2real.diagnose.explaining import Identified, identify_regime, too_little
from sim2real.diagnose.finding import Account, Sight
from sim2real.diagnose.gantry.problem import gantry_problem
from sim2real.diagnose.gantry.run import UnusableError
from sim2real.diagnose.glide.data import GlideData, join
from sim2real.diagnose.glide.problem import GlideProblem, States
from sim2real.diagnose.impacts import Impact, find_impacts
from sim2real.diagnose.mallet.data import Blows, blows
from sim2real.diagnose.mallet.problem import MalletProblem
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.sanity import UndeterminedError
from sim2real.diagnose.sensing.account import Sensed, sense
from sim2real.diagnose.sensing.agreement import check_sensing
from sim2real.diagnose.sight import sight
from sim2real.diagnose.split import glides_of, launches_of
from sim2real.diagnose.wall.data import bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.recording import Recording

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Whole:
    """What all regimes lack: the sensing (None where no frames tell), the others by name, and the sensors."""

    sensed: Sensed
    sights: tuple[Sight, ...]
    regimes: Mapping[str, Identified] = field(default_factory=dict)

    @property
    def accounts(self) -> tuple[Account, ...]:
        """The accounts of all regimes."""
        return (self.sensed.account, *(one.account for one in self.regimes.values()))


@dataclass(frozen=True)
class Cut:
    """Recordings of one table, cut up."""

    recordings: Sequence[Recording]
    pieces: Sequence[Pieces]


def identify(
    recordings: Sequence[Recording], paths: Sequence[Recording], values: Mapping[str, float], progress: Progress
) -> Whole:
    """What the recordings lack: of the puck by the frames of `recordings`, of the gantry by the mallet's path in
    `paths`, the same recordings. `values`: the simulator's parameters by name.

    UndeterminedError where nothing can be said.
    """
    progress("cutting", 0.05)
    pieces = [cut(one) for one in recordings]
    check_sensing(recordings, pieces)
    progress("sensing", 0.1)
    sensed = sense(recordings, pieces, launches_of(recordings, pieces))
    if sensed.account.undetermined:
        raise UndeterminedError(sensed.account.undetermined, sensed.account.next_recording)
    data = Cut(sensed.recordings, sensed.pieces)
    parts = [glides_of(*one) for one in zip(data.recordings, data.pieces, strict=True)]
    sights = tuple(sight(*one) for one in zip(data.recordings, data.pieces, parts, strict=True))
    gantry = _gantry(data.pieces, paths, values, progress)
    puck = _puck(data, parts, sights, values, progress)
    return Whole(sensed, sights, {one.account.regime: one for one in (*puck, *gantry)})


def _puck(
    data: Cut, parts: Sequence[GlideData], sights: Sequence[Sight], values: Mapping[str, float], progress: Progress
) -> Iterator[Identified]:
    """The puck's regimes, in the order in which one leans on the other: contacts are known by the glides. None where no
    puck was seen."""
    if not any(seen.frames and seen.dropped < 1.0 for seen in sights):
        return
    progress("glides", 0.2)
    if not sum(part.glides for part in parts):
        yield Identified(None, too_little("glide"))
        return
    glides = GlideProblem(join(parts), values)
    tables = parts_of(glides.data, [one.name for one in data.recordings])
    found = identify_regime(glides, values, tables)
    yield found
    law = {**values, **({} if found.final is None else found.final.final.values)}
    states = states_of(glides, found.final, law)
    rests_on = (found.clear, found.clear and not found.account.lost)
    progress("bounces", 0.6)
    impacts = [find_impacts(pieces, glides, states, k) for k, pieces in enumerate(data.pieces)]
    hits = bounces([hit for some in impacts for hit in some], geometry(data.recordings[0]))
    yield identify_regime(WallProblem(hits, glides.clusters, law), law, tables, *rests_on)
    progress("blows", 0.75)
    struck = blows_of(data.recordings, impacts)
    if struck is not None:
        yield identify_regime(MalletProblem(struck, glides.clusters, law), law, tables, *rests_on)


def _gantry(
    pieces: Sequence[Pieces], paths: Sequence[Recording], values: Mapping[str, float], progress: Progress
) -> Iterator[Identified]:
    """The gantry; none where its path was not recorded."""
    if all(one.mallet is None for one in paths):
        return
    progress("gantry", 0.2)
    touched = blow_times(pieces)
    try:
        problem, runs = gantry_problem(paths, values, touched)
    except UnusableError as why:
        yield Identified(None, Account("gantry", (), {}, False, None, str(why)))
        return
    problem = problem.ticked()
    tables = [Part(paths[k].name, part) for k, part in zip(runs, problem.clusters_of_runs, strict=True)]
    alone = not any(len(times) for times in touched)
    yield identify_regime(problem, values, tables, alone, alone)


def blow_times(pieces: Sequence[Pieces]) -> list[np.ndarray]:
    """When [s] the puck struck the robot's mallet, in each recording."""
    return [np.array([hit.t for hit in part.hits if hit.where == "robot"]) for part in pieces]


def states_of(glides: GlideProblem, found: Explained | None, law: Mapping[str, float]) -> States:
    """The ends of glides under what was found of them, or under the numbers `law` where nothing could be."""
    if found is None:
        return glides.states(given(law))
    if found.unlisted is None or found.switched():
        return glides.states(replace(found.final, values=found.mended))
    return glides.states(found.final, found.unlisted.name, found.coefficients)


def blows_of(recordings: Sequence[Recording], impacts: Sequence[list[Impact]]) -> Blows | None:
    """The blows of the robot's mallet in all recordings that know where it was; None where there are none."""
    read = [(read_encoders(one), geometry(one), some) for one, some in zip(recordings, impacts, strict=True)]
    parts = [blows(some, encoders, g) for encoders, g, some in read if encoders is not None]
    parts = [part for part in parts if len(part)]
    return join_contacts(parts) if parts else None
