"""The design matrix of a glide problem: the columns of listed effects and of nonparametric forces."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.problem import DesignMatrix, Residuals
from sim2real.diagnose.regimes.sliding.as_effect import effect_parameters
from sim2real.diagnose.regimes.sliding.basis_library import FAMILIES, SPIN, WAVES, Motion
from sim2real.diagnose.regimes.sliding.residuals import GlideResiduals
from sim2real.diagnose.regimes.sliding.tuned import SLIDING

MOVES = (-1, 0, 1)  # steps to places nearby
BY_SPIN = "spin_side_force"  # depends on the spin, which the camera does not measure: the family SPIN represents it

Columns = Callable[[np.ndarray], np.ndarray]  # accelerations (n, 2, k) [m/s^2] to columns (2n, k) of the residuals


def listed_laws() -> list[Law]:
    """The listed effects of the glide whose columns are derivatives at the baseline; patches need a search."""
    found = []
    for name, effect in EFFECTS.items():
        if effect.regime != "glide" or not effect.listed or name == "friction_patch":
            continue
        rows = tuple(row.name for row in effect.rows.values() if row.name != BY_SPIN)
        found.append(Law(name, rows))
    return found


def glide_columns(
    problem: GlideResiduals, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: str = ""
) -> DesignMatrix:
    """All columns of a glide problem at the parameters `values`, including those of the parameters `free`.

    Friction patches are searched in the clusters `use`; not at all if `use` is None. `only`: see `Problem.columns`.
    """
    path, by_start = problem.linearized(values)
    motion = problem.motion(path)

    def columns(force: np.ndarray) -> np.ndarray:
        return problem.profiled(path, by_start, problem.displacements(path, values, force)[0])[1]

    listed = listed_laws()
    free = tuple(dict.fromkeys((*problem.base, *(name for law in listed for name in law.columns), *free)))
    exact = problem.residuals(values, free, np.arange(problem.clusters))
    patches, patch_columns = [], np.zeros((len(exact.r), 0))
    if use is not None:
        patches, patch_columns = _patches(motion, columns, exact, len(problem.base), np.isin(exact.cluster, use))
    blocks, names, families = [exact.jacobian, patch_columns], [*free, *(law.columns[0] for law in patches)], []
    for name, (depends, shape) in FAMILIES.items():
        if only not in ("", name):
            continue
        block = columns(shape(motion))
        own = tuple(f"{name} {k}" for k in range(block.shape[1]))
        mechanism = "side_force" if name == SPIN else "unlisted"
        switch = partial(effect_parameters, name, motion)
        family = Law(name, own, depends, switch=switch, mechanism=mechanism, each_launch=name == SPIN)
        if name in WAVES:
            family = replace(family, searched=len(WAVES), variant_of="brake by a wave in time")
        families.append(family)
        names += families[-1].columns
        blocks.append(block)
    glide = np.repeat(np.arange(problem.data.glides), 2 * np.diff(problem.data.first))
    equations = normal_equations.make_equations(names, exact.r, blocks, glide, problem.data.glides)
    return DesignMatrix(equations, [*listed, *patches], families)


def _patches(
    motion: Motion, columns: Columns, exact: Residuals, base: int, used: np.ndarray
) -> tuple[list[Law], np.ndarray]:
    """Search the friction discs that explain most of the `used` (n,) bool residuals, one disc at a time.

    The search is done twice: with the first `base` parameters free, and with all of them free, whose columns may be
    collinear with a disc's. Returns the laws and their columns (n, k) for all residuals.
    """
    rests = [_Rest.of(exact.r[used], exact.jacobian[used, :known]) for known in (base, exact.jacobian.shape[1])]

    def gains(discs: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        block = columns(_inside(motion, discs))
        return np.stack([rest.gains(block[used]) for rest in rests]), block / SLIDING.unit

    grid = _discs(motion.size)
    score = np.concatenate(
        [gains(grid[k : k + SLIDING.patch_chunk])[0] for k in range(0, len(grid), SLIDING.patch_chunk)], axis=1
    )
    order = np.argsort(-score, axis=1)[:, : SLIDING.patches_kept]
    best, beside = grid[order.ravel()], np.repeat(np.arange(len(rests)), SLIDING.patches_kept)
    for finer in range(1, SLIDING.patch_refinements + 1):
        for k, disc in enumerate(best):
            near = _near(disc, 0.5**finer)
            best[k] = near[np.argmax(gains(near)[0][beside[k]])]
    laws = [_patch(f"patch_extra@{k}", disc, len(grid)) for k, disc in enumerate(best)]
    return laws, gains(best)[1]


@dataclass(frozen=True)
class _Rest:
    """Residuals `r` (n,) minus their projection on known columns, which span the orthonormal `basis` (n, k)."""

    basis: np.ndarray
    r: np.ndarray

    @classmethod
    def of(cls, r: np.ndarray, known: np.ndarray) -> _Rest:
        """Project the columns `known` (n, k) out of the residuals `r` (n,)."""
        basis = np.linalg.qr(known / np.maximum(np.linalg.norm(known, axis=0), 1e-300))[0]
        return cls(basis, r - basis @ (basis.T @ r))

    def gains(self, block: np.ndarray) -> np.ndarray:
        """The decrease (k,) of the sum of squares by each column of `block` (n, k) in addition to the known ones."""
        alone = block - self.basis @ (self.basis.T @ block)
        size = np.einsum("ik,ik->k", alone, alone)
        return np.where(size > 1e-9, (alone.T @ self.r) ** 2 / np.maximum(size, 1e-9), 0.0)


def _near(disc: np.ndarray, share: float) -> np.ndarray:
    """The disc and its neighbours (k, 3), at steps of a `share` of the grid's steps."""
    x, y, radius = disc
    step = share * _spacing(radius)
    near = [
        (x + i * step, y + j * step, radius * (1.0 + SLIDING.patch_growth * share * k))
        for i in MOVES
        for j in MOVES
        for k in MOVES
    ]
    return np.array(near)


def _patch(column: str, disc: np.ndarray, searched: int) -> Law:
    """The law of a friction patch at a disc (3,), selected among `searched` discs."""
    x, y, radius = map(float, disc)
    start = {"patch_x": x, "patch_y": y, "patch_radius": radius}
    return Law("friction_patch", (column,), start=start, searched=searched)


def _discs(size: np.ndarray) -> np.ndarray:
    """Centres and radii (k, 3) [m] of discs that cover a table of `size` (2,) [m]; small discs are closer together."""
    found = []
    for radius in SLIDING.patch_radii:
        step = _spacing(radius)
        x = np.linspace(0.0, size[0], max(int(size[0] / step), 2) + 1)
        y = np.linspace(0.0, size[1], max(int(size[1] / step), 2) + 1)
        found.append(np.array([(a, b, radius) for a in x for b in y]))
    return np.concatenate(found)


def _spacing(radius: float) -> float:
    """Distance [m] of neighbouring discs of a radius [m]."""
    return max(SLIDING.patch_spacing * radius, SLIDING.least_patch_spacing)


def _inside(motion: Motion, discs: np.ndarray) -> np.ndarray:
    """Accelerations (n, 2, k) [m/s^2] of one unit of additional friction inside each disc (k, 3)."""
    x, y, radius = discs.T
    inside = np.subtract.outer(motion.place[:, 0], x) ** 2 + np.subtract.outer(motion.place[:, 1], y) ** 2 < radius**2
    return (-SLIDING.unit * motion.along)[:, :, None] * inside[:, None, :]
