"""A regime small enough to check by hand: residuals that are linear in its parameters, and white noise."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from sim2real.diagnose.engine import normal_equations
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import DesignMatrix, Problem, Residuals, Units
from sim2real.diagnose.regimes.base import Evidence, Known, RecordingPart, Regime
from sim2real.diagnose.regimes.formula_words import mismatch_by_launch
from sim2real.diagnose.result.result import Mismatch

LAUNCHES, PIECES, EACH = 20, 3, 20
NAMES = ("friction", "drag", "tilt_x", "tilt_y", "linear_drag", "spin")
SHIPPED = {"friction": 0.125, "drag": 0.125}
FELT = 50.0  # standard deviations of the noise that a parameter of 1 makes of a residual


def _switched(taken_at: np.ndarray, theta: np.ndarray) -> dict[str, float]:
    """No place in the simulator; a function of its own each time that columns are taken."""
    return {}


class LinearProblem:
    """`truth`: parameters by name, each a number or one for each launch; `noise`: in units of the sensor's;
    `likeness`: whether the tilt is a family's, instead of a listed law's; `spinning`: whether there is a family that
    has a number, "spin", of each launch's own."""

    regime = "glide"
    base: tuple[str, ...] = ("friction", "drag")
    first_fitted: tuple[str, ...] = base
    noise_m = 0.001
    place_error_m = 0.0

    def __init__(
        self,
        truth: Mapping[str, float | np.ndarray],
        noise: float = 1.0,
        seed: int = 0,
        likeness: bool = False,
        spinning: bool = False,
    ) -> None:
        rng = np.random.default_rng(seed)
        self.clusters, self.truth, self.likeness, self.spinning = LAUNCHES, truth, likeness, spinning
        self.launch = np.repeat(np.arange(LAUNCHES), PIECES * EACH)
        self.felt = FELT * rng.normal(size=(len(self.launch), len(NAMES)))
        self.seen = noise * rng.normal(size=len(self.launch))
        for k, name in enumerate(NAMES):
            of_launch = np.broadcast_to(np.asarray(truth.get(name, SHIPPED.get(name, 0.0))), LAUNCHES)
            self.seen += of_launch[self.launch] * self.felt[:, k]
        self.units = Units(np.repeat(np.arange(LAUNCHES), PIECES), np.full(LAUNCHES * PIECES, float(EACH)))
        self.freedom = np.full(LAUNCHES, float(PIECES * EACH))

    def feel_nothing(self, launches: np.ndarray, names: Sequence[str]) -> None:
        """Let these parameters do nothing to these launches."""
        here = np.isin(self.launch, launches)
        for name in names:
            k = NAMES.index(name)
            self.seen[here] -= self.truth[name] * self.felt[here, k]
            self.felt[here, k] = 0.0

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`."""
        left = self.seen - self.felt @ np.array([values.get(name, 0.0) for name in NAMES])
        here = np.isin(self.launch, clusters)
        jacobian = -self.felt[:, [NAMES.index(name) for name in free]]
        return Residuals(left[here], jacobian[here], self.launch[here])

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> DesignMatrix:
        """See `Problem.columns`."""
        exact = self.residuals(values, NAMES, np.arange(LAUNCHES))
        piece = np.repeat(np.arange(LAUNCHES * PIECES), EACH)
        equations = normal_equations.make_equations(NAMES, exact.r, exact.jacobian, piece, LAUNCHES * PIECES)
        columns = ("tilt_x", "tilt_y")
        if self.spinning:
            own = exact.jacobian[:, NAMES.index("spin"), None] * (self.launch[:, None] == np.arange(LAUNCHES))
            spins = tuple(f"spin {k}" for k in range(LAUNCHES))
            equations = normal_equations.make_equations(
                (*NAMES, *spins), exact.r, np.hstack([exact.jacobian, own]), piece, LAUNCHES * PIECES
            )
            family = Law("side force by spin", spins, "history", mechanism="side_force", each_launch=True)
            return DesignMatrix(equations, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [family])
        if self.likeness:
            return DesignMatrix(
                equations, [], [Law("push by place", columns, "position", switch=partial(_switched, self.launch))]
            )
        return DesignMatrix(equations, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [])


class LinearRegime(Regime):
    """A regime whose problem is a `LinearProblem`; what it takes as given stands, or does not."""

    name = "glide"
    more_of = "launches of the puck"
    least_size = 5e-4

    def __init__(self, stands: bool = True) -> None:
        self.stands = stands

    def parameters(self, evidence: Evidence, known: Known) -> Mapping[str, float]:
        return SHIPPED

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        return True, self.stands

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        return []

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        return mismatch_by_launch(problem, found, self.unit)


NO_EVIDENCE = Evidence((), (), (), (), {})
