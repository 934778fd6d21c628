"""Identify a stretch or shear of the map from image to table, from the walls' contact lines and the bounces there.

A stretch moves the far lines outwards and not the near ones; a wrong radius of the puck moves all lines inwards
equally; a shear slants the short walls, and deflects bounces off the long ones. In glides a stretch is equivalent to a
change of drag and friction, so only contacts are used.
"""

from __future__ import annotations

from collections.abc import Set
from dataclasses import dataclass

import numpy as np
from scipy import stats

from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.regimes.contact.tuned import CONTACT
from sim2real.diagnose.regimes.sensing.bounce_angles import BounceAngles, bounce_angles, deflections
from sim2real.diagnose.regimes.sensing.contact_lines import ContactLine, contact_lines
from sim2real.diagnose.regimes.sensing.held_out import held_out_errors
from sim2real.diagnose.regimes.sensing.tuned import SCALE, SIGNIFICANCE_LEVEL
from sim2real.diagnose.result.result import Estimate, Finding, Proof, explained
from sim2real.segmentation.causes import Geometry, nominal_lines, wall_axis
from sim2real.segmentation.velocity_jumps import VelocityJump
from sim2real.statistics.intervals import NORMAL_REACH

NAMES = ("scale_x", "scale_y", "shear")


@dataclass(frozen=True)
class ScaleResult:
    """`values` (3,) in the order of NAMES, 0 where no error was found; `selection`: the cross-validated errors;
    `undetermined`: why the lines contradict the table's size, "" if they do not."""

    values: np.ndarray
    findings: tuple[Finding, ...]
    selection: Proof | None
    undetermined: str = ""


def identify_scale(found: list[VelocityJump], g: Geometry, calibrated: bool = False) -> ScaleResult:
    """Identify the camera's map error from the velocity jumps `found` at the walls, cross-validated over launches.

    For a `calibrated` camera, an error is reported only if it explains nearly all of the misfit, because apparent wall
    contacts may be contacts with a mallet under the gantry.
    """
    values, covariance = fitted_map(found, g)
    std = np.sqrt(np.diag(covariance))
    wrong = wrong_size(values, std, g)
    if wrong:
        return ScaleResult(np.zeros(3), (), None, wrong)
    p_values, known = 2 * stats.norm.sf(np.abs(values) / std), std < SCALE.known
    together = values[known] @ np.linalg.solve(covariance[np.ix_(known, known)], values[known])
    chance = float(stats.chi2.sf(together, max(known.sum(), 1)))
    if chance > SIGNIFICANCE_LEVEL or not np.any(
        (p_values < SCALE.significance) & (np.abs(values) > SCALE.least_scale) & known
    ):
        return ScaleResult(np.zeros(3), (), None)
    named = (p_values < SCALE.significance) & known
    kept = np.where(named, values, 0.0)
    sizes = held_out_errors(*_left_out(found, g).T)
    share = 0.0 if sizes is None else explained(sizes.before, sizes.after)
    if sizes is None or share <= 0.0 or (share < SCALE.least_explained and (calibrated or chance > SCALE.beyond_doubt)):
        return ScaleResult(np.zeros(3), (), None)
    half = NORMAL_REACH * std
    estimates = {
        name: Estimate(float(values[k]), float(values[k] - half[k]), float(values[k] + half[k]), "1")
        for k, name in enumerate(NAMES)
        if named[k]
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
    return ScaleResult(kept, (finding,), sizes.proof)


def fitted_map(found: list[VelocityJump], g: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (3,) of NAMES and their covariance (3, 3), which is large if the jumps do not determine them."""
    return _solve(contact_lines(found, g), g)


def wrong_size(values: np.ndarray, std: np.ndarray, g: Geometry) -> str:
    """The reason why the table's size is wrong: a large scale, or any scale if the size is assumed; "" if it is not."""
    most = SCALE.most_warped_scale if _is_warped(values, std) else SCALE.most_scale
    for axis, (name, size) in enumerate((("length", g.length), ("width", g.width))):
        off, assumed = abs(values[axis]), name in g.assumed
        surely = off > SCALE.least_scale + 3 * std[axis] if assumed else off > most
        if (surely and std[axis] < SCALE.known) or (off > most + 2 * std[axis] and std[axis] < SCALE.roughly_known):
            measured, how = (1 + values[axis]) * size, "assumed" if assumed else "stated"
            return (
                f"the {how} {name} of {size:.3f} m differs by {off:.1%} from the observed {measured:.3f} m: "
                "measure the table and state its size, or calibrate the camera"
            )
    return ""


def _is_warped(values: np.ndarray, std: np.ndarray) -> bool:
    """Whether a map is significantly sheared, or stretched by different factors along both axes.

    A wrong measurement of the table affects one size, or both by the same factor.
    """
    x, y, _ = values
    clear = (np.abs(values) > SCALE.least_warp + 3 * std) & (std < SCALE.known)
    return bool(clear[2] or (clear[0] and clear[1] and abs(x - y) > SCALE.least_scale + 3 * np.hypot(std[0], std[1])))


def _design(
    walls: dict[str, ContactLine], angles: BounceAngles, g: Geometry
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """What is known of n walls and of k that deflect bounces: the lines' displacements from nominal and the angles
    (2n + k,), the Jacobian (2n + k, 7) by NAMES, radius, offsets and turn, and their covariance."""
    nominal = nominal_lines(g)
    moved, rows, slant_of = [], [], {}
    covariance = np.zeros((2 * len(walls) + len(angles.walls),) * 2)
    for k, (wall, line) in enumerate(walls.items()):
        axis, inward = wall_axis(wall)
        place, slant = np.zeros(7), np.zeros(7)
        place[axis], place[3], place[4 + axis] = nominal[wall], inward, 1.0
        slant[6] = (1.0, -1.0)[axis]
        if axis == 0:
            place[2], slant[2] = g.width / 2, 1.0
        rows += [place, slant]
        moved += [line.values[0] - nominal[wall], line.values[1]]
        covariance[2 * k : 2 * k + 2, 2 * k : 2 * k + 2] = line.covariance + np.diag(
            np.square([SCALE.wall_place_std, SCALE.wall_slant_std])
        )
        slant_of[wall] = 2 * k + 1
    covariance[2 * len(walls) :, 2 * len(walls) :] = angles.covariance
    for k, (wall, value) in enumerate(zip(angles.walls, angles.values, strict=True), 2 * len(walls)):
        axis, _ = wall_axis(wall)
        rows.append(np.array([0.0, 0.0, axis, 0.0, 0.0, 0.0, (-1.0, 1.0)[axis]]))
        moved.append(value)
        covariance[k, k] += SCALE.wall_slant_std**2  # a wall that is slanted itself deflects by the opposite angle
        covariance[k, slant_of[wall]] = covariance[slant_of[wall], k] = -(SCALE.wall_slant_std**2)
    return np.array(moved), np.array(rows).reshape(-1, 7), covariance


def _solve(walls: dict[str, ContactLine], g: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """Estimates (3,) of NAMES and their covariance (3, 3). Bounces are left out if the slants of the short walls' lines
    contradict the shear that they show: walls that are turned where they are deflect bounces too."""
    by_lines, spread = _solve_with(walls, BounceAngles((), np.zeros(0), np.zeros((0, 0))), g)
    by_both, less = _solve_with(walls, bounce_angles(walls), g)
    off = abs(by_both[2] - by_lines[2]) / np.sqrt(spread[2, 2] + less[2, 2])
    return (by_lines, spread) if off > SCALE.contradicted else (by_both, less)


def _solve_with(walls: dict[str, ContactLine], angles: BounceAngles, g: Geometry) -> tuple[np.ndarray, np.ndarray]:
    """The same by these lines and angles, with the errors of a good calibration as a prior."""
    moved, jacobian, covariance = _design(walls, angles, g)
    weight = np.linalg.inv(covariance)
    radius, offset, turn = (std**-2 for std in (SCALE.radius_std, SCALE.offset_std, SCALE.turn_std))
    prior = np.diag([1.0, 1.0, 1.0, radius, offset, offset, turn])  # the prior of a scale has a std of 100 %
    inverse = np.linalg.inv(jacobian.T @ weight @ jacobian + prior)
    return (inverse @ (jacobian.T @ (weight @ moved)))[:3], inverse[:3, :3]


def distances_of_others(found: list[VelocityJump], values: np.ndarray, g: Geometry) -> np.ndarray:
    """Errors (n, 4) of holdout contacts under the map `values`; see `_errors`."""
    return _errors(contact_lines(found, g), values, {s.launch for s in found}, g)


def _left_out(found: list[VelocityJump], g: Geometry) -> np.ndarray:
    """Cross-validated `_errors` (n, 4) of all contacts: each under a map fitted without its launch."""
    launches = sorted({s.launch for s in found})
    lines, rows = contact_lines(found, g), [np.zeros((0, 4))]
    for fold in range(min(SCALE.folds, len(launches))):
        skip = set(launches[fold :: SCALE.folds])
        values, covariance = _solve(contact_lines(found, g, skip), g)
        rows.append(_errors(lines, np.where(np.sqrt(np.diag(covariance)) < SCALE.known, values, 0.0), skip, g))
    return np.concatenate(rows)


def _errors(walls: dict[str, ContactLine], values: np.ndarray, launches: Set[int], g: Geometry) -> np.ndarray:
    """Errors (n, 4) of the contacts in `launches`: under the camera's own map and under the map `values` [m], standard
    deviation [m], and launch. They are distances from the walls' lines, and how far `deflections` of bounces off the
    long walls lead in `CONTACT.flight_time`."""
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
    turned = deflections(walls, float(values[2]))
    turned = turned[np.isin(turned[:, 3], list(launches))] * [*np.full(3, CONTACT.flight_time), 1.0]
    return np.concatenate([*rows, turned])
