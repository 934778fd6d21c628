"""A stretch of one wall where the share of the speed that is kept is another: its search, and its name.

The name holds what was found, so that it alone makes the same stretch again.
"""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from sim2real.diagnose.engine.linear.rest import Rest
from sim2real.diagnose.engine.problem import Residuals
from sim2real.diagnose.regimes.contact.candidates import COMPONENTS, columns_of_shares
from sim2real.diagnose.regimes.contact.problem import ContactProblem
from sim2real.diagnose.regimes.wall.data import KINDS, WallContacts, place_along_wall
from sim2real.diagnose.regimes.wall.tuned import WALL

_NAME = re.compile(r"a stretch of (x0|x1|y0|y1) from (-?[\d.]+) m to (-?[\d.]+) m")


@dataclass(frozen=True)
class Stretch:
    """The stretch of a `wall` from `low` to `high` [m] along it."""

    wall: str
    low: float
    high: float

    @property
    def name(self) -> str:
        """Its name, from which `stretch_named` makes it again."""
        return f"a stretch of {self.wall} from {self.low:.4f} m to {self.high:.4f} m"

    def inside(self, data: WallContacts) -> np.ndarray:
        """1 (n, 1) for contacts with it, 0 for others."""
        s = place_along_wall(data)
        return ((data.kind == KINDS[self.wall]) & (s >= self.low) & (s < self.high)).astype(float)[:, None]

    def numbers(self, data: WallContacts, added: np.ndarray) -> np.ndarray:
        """The numbers of the simulator's effect for a share (1,) that is added."""
        return np.array([list(KINDS).index(self.wall), self.low, self.high, *added])


def stretch_named(name: str) -> Stretch | None:
    """The stretch of this name; None if it is not one of these."""
    found = _NAME.fullmatch(name)
    return Stretch(found[1], float(found[2]), float(found[3])) if found else None


def find_stretches(
    problem: ContactProblem[WallContacts], values: Mapping[str, float], exact: Residuals, base: int, use: np.ndarray
) -> tuple[list[Stretch], int]:
    """The stretches that explain most of the clusters `use` beside the first `base` parameters of the residuals
    `exact`, and beside all of them, for each component of a velocity; and the number of those that were compared."""
    used = np.isin(exact.cluster, use)
    rests = [Rest.of(exact.r[used], exact.jacobian[used, :known]) for known in (base, exact.jacobian.shape[1])]
    tried = list(_stretches(problem.data, np.isin(problem.data.cluster, use)))
    if not tried:
        return [], 0
    inside = np.concatenate([one.inside(problem.data) for one in tried], axis=1)
    found: list[Stretch] = []
    for axes in COMPONENTS.values():
        columns = columns_of_shares(problem, values, inside, axes)[used]
        gains = [rest.gains(columns) for rest in rests]
        found += [tried[int(np.argmax(gain))] for gain in gains if gain.max() > WALL.least_stretch_gain]
    return list(dict.fromkeys(found)), len(tried)


def _stretches(data: WallContacts, used: np.ndarray) -> Iterator[Stretch]:
    """Stretches between any two of some edges, that divide the contacts of a wall evenly; not nearly all of a wall."""
    s = place_along_wall(data)
    for wall, kind in KINDS.items():
        own = np.sort(s[used & (data.kind == kind)])
        between = 0.5 * (own[1:] + own[:-1])  # an edge is halfway between two contacts
        edges = _some(np.concatenate([own[:1] - 1e-3, between, own[-1:] + 1e-3]))
        for i, low in enumerate(edges):
            for high in edges[i + 1 :]:
                count = int(((own >= low) & (own < high)).sum())
                if WALL.fewest_of_stretch <= count <= len(own) - WALL.fewest_of_stretch:
                    yield Stretch(wall, round(float(low), 4), round(float(high), 4))


def _some(edges: np.ndarray) -> Sequence[float]:
    """Some of the edges, evenly."""
    if len(edges) <= WALL.stretch_edges:
        return edges.tolist()
    return edges[np.linspace(0, len(edges) - 1, WALL.stretch_edges).round().astype(int)].tolist()
