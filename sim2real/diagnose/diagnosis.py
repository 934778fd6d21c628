"""Recordings in, a diagnosis out: each regime explained in turn, the glides first, since hits are told by them."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.account import account
from sim2real.diagnose.contacts import geometry, mallet_tracks
from sim2real.diagnose.engine.explain import explain
from sim2real.diagnose.finding import Account, Finding, Proof, Sight
from sim2real.diagnose.glide.data import GlideData, glide_data, join
from sim2real.diagnose.glide.problem import GlideProblem
from sim2real.diagnose.illustrate import illustrated
from sim2real.diagnose.impacts import Impact, find_impacts
from sim2real.diagnose.pieces import Pieces, cut
from sim2real.diagnose.problem import Problem
from sim2real.diagnose.sight import sight
from sim2real.diagnose.wall.data import bounces
from sim2real.diagnose.wall.problem import WallProblem
from sim2real.nominal import parameters
from sim2real.recording import Recording

KEPT_APART = 4  # every so manieth launch serves the proof alone
FEWEST_LAUNCHES = 6
FEWEST_RESIDUALS = 24
TOO_LITTLE = "too little data"

Progress = Callable[[str, float], None]


@dataclass(frozen=True)
class Diagnosis:
    """All accounts, by regime. `reason`: why nothing can be said, "" if something can. `sights`: the sensor of each
    recording, those held out last."""

    accounts: tuple[Account, ...]
    reason: str = ""
    sights: tuple[Sight, ...] = ()

    @property
    def findings(self) -> list[Finding]:
        """All findings, strongest first."""
        return sorted((one for each in self.accounts for one in each.findings), key=lambda one: one.p_value)

    @property
    def verdict(self) -> str:
        """agrees, parameters_only, missing_physics or undetermined."""
        if self.findings:
            return "missing_physics"
        told = [each for each in self.accounts if not each.undetermined]
        if self.reason or not told:
            return "undetermined"
        return "agrees" if all(each.shipped for each in told) else "parameters_only"

    @property
    def next_recording(self) -> str:
        """What to record next, in one sentence; "" where nothing is open."""
        return next((each.next_recording for each in self.accounts if each.next_recording), "")

    @property
    def proof(self) -> Proof | None:
        """Held-out residuals over the regimes with findings, or over all where there are none."""
        lacking = [each for each in self.accounts if each.findings] or self.accounts
        some = [each.proof for each in lacking if each.proof is not None]
        if not some:
            return None
        pieces = sum(one.pieces for one in some)
        sizes = [
            float(np.sqrt(sum(one.pieces * getattr(one, name) ** 2 for one in some) / max(pieces, 1)))
            for name in ("before_m", "after_m", "floor_m")
        ]
        return Proof(sizes[0], sizes[1], sizes[2], pieces)


@dataclass(frozen=True)
class Cut:
    """Recordings of one table, cut up. `heldout`: how many of the last ones serve the proof alone."""

    recordings: Sequence[Recording]
    pieces: Sequence[Pieces]
    heldout: int


def diagnose(
    recordings: Sequence[Recording], heldout: Sequence[Recording], shipped: Mapping[str, float], progress: Progress
) -> Diagnosis:
    """Explain `recordings`, and prove it on `heldout` or, where there are none, on launches kept apart."""
    progress("cutting", 0.0)
    every = [*recordings, *heldout]
    data = Cut(every, [cut(one) for one in every], len(heldout))
    values = parameters(recordings[0], shipped)
    accounts = list(_puck(data, values, progress))
    sights = tuple(sight(one, pieces) for one, pieces in zip(data.recordings, data.pieces, strict=True))
    return Diagnosis(tuple(accounts), "" if accounts else TOO_LITTLE, sights)


def _puck(data: Cut, values: dict[str, float], progress: Progress):
    """Accounts of the puck's regimes, in the order in which one leans on the other."""
    progress("glides", 0.2)
    parts = [_glides(one, pieces) for one, pieces in zip(data.recordings, data.pieces, strict=True)]
    glides = GlideProblem(join(parts), values)
    proof = _kept_apart(glides, parts, data.heldout)
    law = dict(values)
    for regime in (glides,):
        found, told = _explain(regime, law, proof)
        yield told
        if found is not None:
            law |= found.law.values
    progress("bounces", 0.6)
    impacts = [hit for k, pieces in enumerate(data.pieces) for hit in find_impacts(pieces, glides, law, k)]
    yield _walls(impacts, glides, data, law, proof)


def _glides(recording: Recording, pieces: Pieces) -> GlideData:
    t = np.zeros(0) if recording.frames is None else recording.frames.t
    return glide_data(pieces, geometry(recording), mallet_tracks(recording, t))


def _walls(impacts: list[Impact], glides: GlideProblem, data: Cut, law: dict[str, float], proof: np.ndarray) -> Account:
    walls = WallProblem(bounces(impacts, geometry(data.recordings[0])), glides.clusters, law)
    return _explain(walls, law, proof)[1]


def _explain(problem: Problem, law: Mapping[str, float], proof: np.ndarray):
    """The engine's findings of a problem (None where there is too little data), and its account."""
    live = np.flatnonzero(problem.freedom > 0)
    use, apart = np.setdiff1d(live, proof), np.intersect1d(live, proof)
    if len(use) + len(apart) < FEWEST_LAUNCHES or not len(apart) or problem.freedom[use].sum() < FEWEST_RESIDUALS:
        return None, Account(problem.regime, (), {}, False, None, TOO_LITTLE)
    shipped = {name: law[name] for name in problem.base}
    found = explain(problem, shipped, use)
    return found, illustrated(problem, found, account(problem, found, apart), use)


def _kept_apart(glides: GlideProblem, parts: Sequence[GlideData], heldout: int) -> np.ndarray:
    """The launches that no fit sees: those of the held-out recordings, or every KEPT_APART-th."""
    clusters = np.arange(glides.clusters)
    if heldout:
        return clusters[sum(part.clusters for part in parts[:-heldout]) :]
    return clusters[KEPT_APART - 1 :: KEPT_APART]
