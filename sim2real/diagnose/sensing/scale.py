"""Whether the map from image to table is stretched or sheared: by the lines on which the puck turns round at the walls.

A stretch moves the far lines outwards and leaves the near ones; a wrong radius of the puck moves all inwards alike; a
shear slants the short walls. From glides alone a stretch is a change of drag and friction, so only the lines are asked.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np
from scipy import stats

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.contacts import Geometry, nominal_lines, wall_axis
from sim2real.diagnose.finding import Estimate, Finding, Proof, explained
from sim2real.diagnose.interval import NORMAL_REACH
from sim2real.diagnose.sensing.lines import Line, lines
from sim2real.diagnose.sensing.measured import SURE, measured
from sim2real.diagnose.strikes import Strike

NAMES = ("scale_x", "scale_y", "shear")
RADIUS, OFFSET, TURN = 0.001, 0.0005, 0.002  # m, m, rad: what a good calibration may be off by
CUSHION = (0.0003, 0.0005)  # m and rad: how straight and true a wall is
TOLD = 1e-3  # the same of one of them, once they are
AT_LEAST = 0.001  # of a size; a smaller error is not told
WRONG_SIZE = 0.022  # of a size; a larger error is that of the size stated, not of the camera,
BENT = 0.05  # unless the map is bent in a way that no wrong size makes: then one larger than this
BENDING = 0.005  # of a shear or of the other size: a smaller one may come with a wrong size
STRETCHED = 0.75  # of what the lines are off by beyond noise, that a map must explain unless it is beyond doubt:
BEYOND_DOUBT = 1e-12  # a stretch explains nearly all, but a few touches that are none may hide that
KNOWN, ROUGHLY = 0.003, 0.01  # errors of a scale above which the lines do not tell it, or not even a wrong size
FOLDS = 20  # nearly one launch at a time: a wall has few touches


@dataclass(frozen=True)
class ScaleAccount:
    """`values` (3,) of NAMES, 0 where nothing is missing; or why the lines cannot be believed, in `undetermined`.
    `selection`: how far off launches are that a fit did not see."""

    values: np.ndarray
    findings: tuple[Finding, ...]
    selection: Proof | None
    undetermined: str = ""


def scale_account(found: list[Strike], g: Geometry, calibrated: bool = False) -> ScaleAccount:
    """What the strikes `found` at the walls say of the camera's map, each launch tried on a fit without it. Against a
    camera that was `calibrated` nothing is told that does not explain nearly all: what looks like touches may be blows
    under the gantry."""
    values, covariance = fitted_map(found, g)
    std = np.sqrt(np.diag(covariance))
    wrong = wrong_size(values, std, g)
    if wrong:
        return ScaleAccount(np.zeros(3), (), None, wrong)
    sure = 2 * stats.norm.sf(np.abs(values) / std)
    chance = float(stats.chi2.sf(values @ np.linalg.solve(covariance, values), len(NAMES)))
    if chance > SURE or not np.any((sure < TOLD) & (np.abs(values) > AT_LEAST) & (std < KNOWN)):
        return ScaleAccount(np.zeros(3), (), None)
    told = (sure < TOLD) & (std < KNOWN)
    kept = np.where(told, values, 0.0)
    sizes = measured(*_left_out(found, g).T)
    share = 0.0 if sizes is None else explained(sizes.before, sizes.after)
    if sizes is None or share <= 0.0 or (share < STRETCHED and (calibrated or chance > BEYOND_DOUBT)):
        return ScaleAccount(np.zeros(3), (), None)
    half = NORMAL_REACH * std
    estimates = {
        name: Estimate(float(values[k]), float(values[k] - half[k]), float(values[k] + half[k]), "1")
        for k, name in enumerate(NAMES)
        if told[k]
    }
    rows = EFFECTS["scale_error"].rows
    finding = Finding(
        regime="sensing",
        mechanism="scale_error",
        also_possible=(),
        depends_on=("position",),
        formula=EFFECTS["scale_error"].law,
        parameters=estimates,
        p_value=max(chance, 1e-300),
        values={rows[name].name: one.value for name, one in estimates.items()},
        ranges={rows[name].name: one for name, one in estimates.items()},
    )
    return ScaleAccount(kept, (finding,), sizes.proof)


def fitted_map(found: list[Strike], g: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (3,) of NAMES and their covariance (3, 3): vast where the strikes do not tell them."""
    return _solve(lines(found, g), g)


def wrong_size(values: np.ndarray, std: np.ndarray, g: Geometry) -> str:
    """Why the size cannot be right: a large error, or any where the size is a mere guess; "" if it may be."""
    most = BENT if _bent(values, std) else WRONG_SIZE
    for axis, (name, size) in enumerate((("length", g.length), ("width", g.width))):
        off, guessed = abs(values[axis]), name in g.assumed
        surely = off > AT_LEAST + 3 * std[axis] if guessed else off > most
        if (surely and std[axis] < KNOWN) or (off > most + 2 * std[axis] and std[axis] < ROUGHLY):
            seen, how = (1 + values[axis]) * size, "guessed" if guessed else "stated"
            return (
                f"the {how} {name} of {size:.3f} m is {off:.1%} off the {seen:.3f} m seen: "
                "measure the table and state its size, or calibrate the camera"
            )
    return ""


def _bent(values: np.ndarray, std: np.ndarray) -> bool:
    """Whether a map is surely sheared, or stretched by different shares along both axes: who measures a table wrongly
    errs in one size, or in both alike."""
    x, y, _ = values
    sure = np.abs(values) > BENDING + 3 * std
    return bool(sure[2] or (sure[0] and sure[1] and abs(x - y) > AT_LEAST + 3 * np.hypot(std[0], std[1])))


def _design(walls: dict[str, Line], g: Geometry) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """The lines' displacements from nominal (2n,), the Jacobian (2n, 7) by NAMES, radius, offsets and turn, and their
    covariance (2n, 2n)."""
    nominal = nominal_lines(g)
    seen, rows = [], []
    covariance = np.zeros((2 * len(walls), 2 * len(walls)))
    for k, (wall, line) in enumerate(walls.items()):
        axis, inward = wall_axis(wall)
        place, slant = np.zeros(7), np.zeros(7)
        place[axis], place[3], place[4 + axis] = nominal[wall], inward, 1.0
        slant[6] = (1.0, -1.0)[axis]
        if axis == 0:
            place[2], slant[2] = g.width / 2, 1.0
        rows += [place, slant]
        seen += [line.values[0] - nominal[wall], line.values[1]]
        covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = line.covariance + np.diag(np.square(CUSHION))
    return np.array(seen), np.array(rows).reshape(-1, 7), covariance


def _solve(walls: dict[str, Line], g: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (3,) of NAMES and their covariance (3, 3), with a good calibration's own errors as a prior."""
    seen, jacobian, covariance = _design(walls, g)
    weight = np.linalg.inv(covariance)
    prior = np.diag([1.0, 1.0, 1.0, RADIUS**-2, OFFSET**-2, OFFSET**-2, TURN**-2])  # a scale: 0 give or take 100 %
    inverse = np.linalg.inv(jacobian.T @ weight @ jacobian + prior)
    return (inverse @ (jacobian.T @ (weight @ seen)))[:3], inverse[:3, :3]


def missed(found: list[Strike], values: np.ndarray, g: Geometry) -> np.ndarray:
    """`_distances` of other touches, under the map `values`."""
    return _distances(lines(found, g), values, {s.launch for s in found}, g)


def _left_out(found: list[Strike], g: Geometry) -> np.ndarray:
    """`_distances` of all touches, each by a map fitted without its launch."""
    launches = sorted({s.launch for s in found})
    whole, rows = lines(found, g), [np.zeros((0, 4))]
    for fold in range(min(FOLDS, len(launches))):
        skip = set(launches[fold::FOLDS])
        values, covariance = _solve(lines(found, g, skip), g)
        rows.append(_distances(whole, np.where(np.sqrt(np.diag(covariance)) < KNOWN, values, 0.0), skip, g))
    return np.concatenate(rows)


def _distances(walls: dict[str, Line], values: np.ndarray, launches: Set[int], g: Geometry) -> np.ndarray:
    """Distances of the touches in `launches` from their lines, by the camera's own map and by the map `values`, their
    errors [m], and their launches: (n, 4)."""
    rows = [np.zeros((0, 4))]
    for wall, line in walls.items():
        here = np.isin(line.launch, list(launches))
        expected = np.full(int(here.sum()), nominal_lines(g)[wall])
        axis, _ = wall_axis(wall)
        moved = expected * (1 + values[axis])
        if axis == 0:
            moved = moved + values[2] * (g.width / 2 + line.along[here])
        place = line.place[here]
        rows.append(np.stack([place - expected, place - moved, line.std[here], line.launch[here]], axis=1))
    return np.concatenate(rows)
