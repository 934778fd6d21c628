"""All that a glide may lack, as columns of its residuals: the listed effects, and smooth forces of any shape."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.glide.families import FAMILIES, SPIN, UNIT, WAVES, Motion
from sim2real.diagnose.glide.glides import Glides
from sim2real.diagnose.glide.switched import switched_on
from sim2real.diagnose.problem import Columns, Residuals

PATCH_RADII = (0.05, 0.1, 0.15, 0.2, 0.3)  # m, at which a patch is looked for
PATCHES_KEPT = 2  # places that are offered, of either search; the law itself has one
CHUNK = 120  # discs at a time: their columns for all frames must fit into memory
FINER, MOVES = 2, (-1, 0, 1)  # rounds of looking nearby, and steps there
SPINNING = "spin_side_force"

Force = Callable[[np.ndarray], np.ndarray]  # accelerations (n, 2, k) to columns of the residuals


def listed_laws() -> list[Law]:
    """The listed effects of the glide whose columns are derivatives at the baseline."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime != "glide" or not effect.listed or name == "friction_patch":
            continue
        rows = tuple(row.name for row in effect.rows.values() if row.name != SPINNING)
        found.append(Law(name, rows))
    return found


def glide_columns(problem: Glides, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
    """Every column of a glide problem at one law; places of other friction are looked for in the clusters `use`."""
    path, by_start = problem.linearised(values)
    motion = problem.motion(path)

    def columns(force: np.ndarray) -> np.ndarray:
        return problem.profiled(path, by_start, problem.bent(path, values, force)[0])[1]

    listed = listed_laws()
    free = tuple(dict.fromkeys((*problem.base, *(name for law in listed for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    patches, patch_columns = [], np.zeros((len(exact.r), 0))
    if use is not None:
        patches, patch_columns = _patches(motion, columns, exact, len(problem.base), np.isin(exact.cluster, use))
    blocks, names, families = [exact.jacobian, patch_columns], [*free, *(law.columns[0] for law in patches)], []
    for name, (depends, shape) in FAMILIES.items():
        block = columns(shape(motion))
        fresh = tuple(f"{name} {k}" for k in range(block.shape[1]))
        mechanism = "side_force" if name == SPIN else "unlisted"
        switch = partial(switched_on, name, motion)
        family = Law(name, fresh, depends, switch=switch, mechanism=mechanism, each_launch=name == SPIN)
        if name in WAVES:
            family = replace(family, searched=len(WAVES), among="brake by a wave in time")
        families.append(family)
        names += families[-1].columns
        blocks.append(block)
    jacobian = np.concatenate(blocks, axis=1)
    glide = np.repeat(np.arange(problem.data.glides), 2 * np.diff(problem.data.first))
    grams = gram.make_grams(names, exact.r, jacobian, glide, problem.data.glides)
    return Columns(grams, [*listed, *patches], families)


def _patches(
    motion: Motion, columns: Force, exact: Residuals, base: int, seen: np.ndarray
) -> tuple[list[Law], np.ndarray]:
    """The discs of other friction that explain most of the residuals that are `seen` (n,) bool, one at a time, beside
    the first `base` parameters, and beside all, where those outshine a disc; with their columns for all residuals."""
    rests = [_Rest.of(exact.r[seen], exact.jacobian[seen, :known]) for known in (base, exact.jacobian.shape[1])]

    def gains(discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        block = columns(_inside(motion, discs))
        return np.stack([rest.gains(block[seen]) for rest in rests]), block / UNIT

    grid = _discs(motion.size)
    score = np.concatenate([gains(grid[k : k + CHUNK])[0] for k in range(0, len(grid), CHUNK)], axis=1)
    order = np.argsort(-score, axis=1)[:, :PATCHES_KEPT]
    best, beside = grid[order.ravel()], np.repeat(np.arange(len(rests)), PATCHES_KEPT)
    for finer in range(1, FINER + 1):
        for k, disc in enumerate(best):
            near = _near(disc, 0.5**finer)
            best[k] = near[np.argmax(gains(near)[0][beside[k]])]
    laws = [_patch(f"patch_extra@{k}", disc, len(grid)) for k, disc in enumerate(best)]
    return laws, gains(best)[1]


@dataclass(frozen=True)
class _Rest:
    """Residuals less what known columns explain, whose space has the orthonormal columns `frame`."""

    frame: np.ndarray
    r: np.ndarray

    @classmethod
    def of(cls, r: np.ndarray, known: np.ndarray) -> _Rest:
        frame = np.linalg.qr(known / np.maximum(np.linalg.norm(known, axis=0), 1e-300))[0]
        return cls(frame, r - frame @ (frame.T @ r))

    def gains(self, block: np.ndarray) -> np.ndarray:
        """What each column (n, k) explains of the rest beside the known ones."""
        alone = block - self.frame @ (self.frame.T @ block)
        size = np.einsum("ik,ik->k", alone, alone)
        return np.where(size > 1e-9, (alone.T @ self.r) ** 2 / np.maximum(size, 1e-9), 0.0)


def _near(disc: np.ndarray, share: float) -> np.ndarray:
    """Discs (k, 3) about one, that itself included, by steps of a share of what those on the grid have."""
    x, y, radius = disc
    step = share * max(0.7 * radius, 0.06)
    some = [(x + i * step, y + j * step, radius * (1.0 + 0.4 * share * k)) for i in MOVES for j in MOVES for k in MOVES]
    return np.array(some)


def _patch(column: str, disc: np.ndarray, searched: int) -> Law:
    x, y, radius = map(float, disc)
    start = {"patch_x": x, "patch_y": y, "patch_radius": radius}
    return Law("friction_patch", (column,), start=start, searched=searched)


def _discs(size: np.ndarray) -> np.ndarray:
    """Middles and radii (k, 3) [m] of discs that cover the table, nearer to each other where they are small."""
    found = []
    for radius in PATCH_RADII:
        step = max(0.7 * radius, 0.06)
        x = np.linspace(0.0, size[0], max(int(size[0] / step), 2) + 1)
        y = np.linspace(0.0, size[1], max(int(size[1] / step), 2) + 1)
        found.append(np.array([(a, b, radius) for a in x for b in y]))
    return np.concatenate(found)


def _inside(motion: Motion, discs: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, k) of a brake of UNIT inside each disc."""
    away = motion.place[:, None, :] - discs[None, :, :2]
    inside = (away**2).sum(axis=2) < discs[:, 2] ** 2
    return -UNIT * motion.along[:, :, None] * inside[:, None, :]
