"""The readable formula of an unlisted law of the gantry, extra volts on its axes, and its picture."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from sim2real.diagnose.binned import binned, half_band, over
from sim2real.diagnose.engine.explain import Explained
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.finding import Curve
from sim2real.diagnose.forms import Axis, Direction, Form, form, harmonic, profiles
from sim2real.diagnose.formula import Formula, Rest, find_formula
from sim2real.diagnose.gantry.families import HARMONICS, answers, baseline_volts, signals, volts_of
from sim2real.diagnose.gantry.problem import GantryProblem

BINS = 30  # of a law's curve
LITTLE = 0.1  # of the rms of what the volts go with: with less of it they tell nothing
ROUNDS = 3  # of Gauss-Newton, after which a formula moves no more
AXES = {"both axes": (0, 1), "x": (0,), "y": (1,)}
# by the last word of a family's name: coordinates in a formula and on a picture, by the names of `families.Signals`
COORDINATES = {
    "place": (("place", "p", "m", "place along the axis [m]"),),
    "speed": (("pace", "speed", "m/s", "speed of the axis [m/s]"),),
    "volts": (
        ("order", "volts", "V", "volts of the axis [V]"),
        ("load", "volts_of_both", "V", "volts of both axes together [V]"),
    ),
    "time": (("t", "t", "s", "time [s]"),),
    "heading": (("angle", "heading", "deg", "heading [°]"),),
}
# by the first word: what the volts go with, its unit per which they are, and how it is said
DRIVERS = {
    "force": ("one", "V", "volts", "volts"),
    "loss": ("v", "V s/m", "volts for each m/s of speed", "times the speed"),
    "pull": ("u", "1", "volts for each volt", "times the volts"),
}


@dataclass(frozen=True)
class _Side:
    """A coordinate of both axes, and what the volts go with: `u`, `by` (2 n,), x before y."""

    symbol: str
    unit: str
    label: str
    u: np.ndarray
    by: np.ndarray


def is_readable(law: Law) -> bool:
    """Whether a family of the gantry has a coordinate that a formula may be of."""
    return law.name.split()[-1] in COORDINATES


def readable(problem: GantryProblem, found: Explained, law: Law, use: np.ndarray) -> tuple[Formula, Curve]:
    """The formula of a family of smooth laws that was found, fitted to the clusters `use`; and its curve."""
    kind, coordinate = law.name.split()[0], law.name.split()[-1]
    _, unit, _, driven = DRIVERS[kind]
    sides = [_side(problem, kind, one) for one in COORDINATES[coordinate]]
    forms: dict[str, tuple[Form, _Side]] = {}
    for side in sides:
        axis = Axis(side.symbol, side.unit, side.u, kind == "force")
        shapes = [harmonic(k, unit) for k in range(1, HARMONICS + 1)] if coordinate == "heading" else None
        for name, axes in AXES.items():
            here = np.repeat([0 in axes, 1 in axes], len(side.u) // 2)
            words = f"{'' if kind == 'force' else f'{driven}, '}on {name}"
            way = Direction("extra volts", "", words, (side.by * here)[:, None])
            made = [form(one, axis, [way], unit) for one in shapes or profiles(axis, unit)]
            forms |= {one.name: (one, side) for one in made}
    rest = _rest(problem, found, use, {})
    best = find_formula(rest, [one for one, _ in forms.values()])
    settled = _settled(problem, found, use, best)
    return settled, _curve(problem, found, law, settled, forms[best.form.name][1])


def _rest(problem: GantryProblem, found: Explained, use: np.ndarray, moved: Mapping[str, float]) -> Rest:
    """What the baseline's numbers leave, each `moved` from where they were found."""
    values = {name: value + moved.get(name, 0.0) for name, value in found.final.values.items()}
    p = problem.record(values)
    left = problem.residuals(values, found.final.free, np.arange(problem.clusters))
    guesses = len(left.r) - sum(2 * len(run.windows.rows) for run in problem.runs)

    def respond(laws: np.ndarray) -> np.ndarray:
        columns = answers(problem, p, np.stack(np.split(laws[:, 0], 2), axis=1))
        return np.concatenate([columns, np.zeros((guesses, columns.shape[1]))])

    return Rest(left.r, left.jacobian, left.cluster, use, respond)


def _settled(problem: GantryProblem, found: Explained, use: np.ndarray, first: Formula) -> Formula:
    """The same form about the numbers that the baseline has beside it, which are far from those that it has alone."""
    best, moved = first, dict.fromkeys(found.final.free, 0.0)
    for _ in range(ROUNDS):
        moved = {name: moved[name] + float(by) for (name, by) in zip(moved, best.moved, strict=True)}
        best = find_formula(_rest(problem, found, use, moved), [best.form])
    whole = np.array(list(moved.values())) + best.moved
    return replace(best, moved=whole, gained=first.gained)


def _side(problem: GantryProblem, kind: str, coordinate: tuple[str, str, str, str]) -> _Side:
    name, symbol, unit, label = coordinate
    both = [signals(problem.runs, axis) for axis in range(2)]
    u, by = (np.concatenate([getattr(one, which) for one in both]) for which in (name, DRIVERS[kind][0]))
    return _Side(symbol, unit, label, u, by)


def _curve(problem: GantryProblem, found: Explained, law: Law, formula: Formula, side: _Side) -> Curve:
    """The smooth law and the formula along a coordinate, both less what the baseline's own numbers could do: extra
    volts on what they go with, by least squares in each bin. The path has no volts of its own to draw beside them."""
    columns = np.concatenate(np.moveaxis(volts_of(problem.runs, law), 1, 0))
    spread = found.theta_covariance[-len(law.columns) :, -len(law.columns) :]
    volts = formula.form.field(formula.values)[:, 0]
    acted = np.concatenate([np.full(len(part), part.any()) for part in np.split(volts, 2)])
    here = acted & (np.abs(side.by) > LITTLE * np.sqrt(np.mean(side.by**2)))
    by, said = side.by[here], _beyond(problem, volts)[here]
    std = 1.0 / np.abs(by)  # of volts on what they go with, where all volts are known alike
    rows = columns[here] / by[:, None]
    shape = binned(side.u[here], rows @ found.coefficients, std, BINS)
    half = half_band(shape, std, rows, spread, found.law.clusters)
    none = np.zeros(0)
    return Curve(
        side.label, f"extra {DRIVERS[law.name.split()[0]][2]}", shape.x, shape.y, shape.y - half, shape.y + half,
        none, none, none, formula=over(shape.members, side.u[here], said / by, std).y,
    )  # fmt: skip


def _beyond(problem: GantryProblem, volts: np.ndarray) -> np.ndarray:
    """Volts (2 n,) less what the baseline's own terms could do of them, axis by axis."""
    left = []
    for axis, part in enumerate(np.split(volts, 2)):
        given = baseline_volts(problem.runs, axis)
        left.append(part - given @ np.linalg.lstsq(given, part, rcond=None)[0])
    return np.concatenate(left)
