"""A regime that can be checked by hand: residuals linear in its parameters, and white noise."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.engine.linear import normal_equations
from sim2real.diagnose.engine.model_search import SearchResult
from sim2real.diagnose.engine.problem import DesignMatrix, Problem, Residuals, Units
from sim2real.diagnose.regimes.base import Evidence, Known, RecordingPart, Regime
from sim2real.diagnose.regimes.formula_words import mismatch_by_launch
from sim2real.diagnose.result.result import Mismatch

LAUNCHES, SEGMENTS, EACH = 20, 3, 20
NAMES = ("friction", "drag", "tilt_x", "tilt_y", "linear_drag", "spin")
DEFAULTS = {"friction": 0.125, "drag": 0.125}
SENSITIVITY = 50.0  # residual of a parameter of 1, in standard deviations of the noise


def _switched(taken_at: np.ndarray, theta: np.ndarray) -> dict[str, float]:
    """Return no parameters of the simulator; a new function for each design matrix."""
    return {}


class LinearProblem:
    """`truth`: parameters by name, each a number or one for each launch; `noise`: in units of the sensor's;
    `smooth`: whether the tilt is a smooth term instead of a listed law; `spinning`: whether there is a smooth term with
    a coefficient "spin" for each launch."""

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
        smooth: bool = False,
        spinning: bool = False,
    ) -> None:
        rng = np.random.default_rng(seed)
        self.clusters, self.truth, self.smooth, self.spinning = LAUNCHES, truth, smooth, spinning
        self.launch = np.repeat(np.arange(LAUNCHES), SEGMENTS * EACH)
        self.sensitivity = SENSITIVITY * rng.normal(size=(len(self.launch), len(NAMES)))
        self.measured = noise * rng.normal(size=len(self.launch))
        for k, name in enumerate(NAMES):
            of_launch = np.broadcast_to(np.asarray(truth.get(name, DEFAULTS.get(name, 0.0))), LAUNCHES)
            self.measured += of_launch[self.launch] * self.sensitivity[:, k]
        self.units = Units(np.repeat(np.arange(LAUNCHES), SEGMENTS), np.full(LAUNCHES * SEGMENTS, float(EACH)))
        self.freedom = np.full(LAUNCHES, float(SEGMENTS * EACH))

    def remove_sensitivity(self, launches: np.ndarray, names: Sequence[str]) -> None:
        """Remove the effect of these parameters on these launches."""
        here = np.isin(self.launch, launches)
        for name in names:
            k = NAMES.index(name)
            self.measured[here] -= self.truth[name] * self.sensitivity[here, k]
            self.sensitivity[here, k] = 0.0

    def residuals(self, values: Mapping[str, float], free: Sequence[str], clusters: np.ndarray) -> Residuals:
        """See `Problem.residuals`."""
        residuals = self.measured - self.sensitivity @ np.array([values.get(name, 0.0) for name in NAMES])
        here = np.isin(self.launch, clusters)
        jacobian = -self.sensitivity[:, [NAMES.index(name) for name in free]]
        return Residuals(residuals[here], jacobian[here], self.launch[here])

    def columns(
        self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None, only: Sequence[Law] = ()
    ) -> DesignMatrix:
        """See `Problem.columns`; there is one smooth term at most."""
        exact = self.residuals(values, NAMES, np.arange(LAUNCHES))
        segment = np.repeat(np.arange(LAUNCHES * SEGMENTS), EACH)
        equations = normal_equations.make_equations(NAMES, exact.r, exact.jacobian, segment, LAUNCHES * SEGMENTS)
        columns = ("tilt_x", "tilt_y")
        if self.spinning:
            own = exact.jacobian[:, NAMES.index("spin"), None] * (self.launch[:, None] == np.arange(LAUNCHES))
            spins = tuple(f"spin {k}" for k in range(LAUNCHES))
            equations = normal_equations.make_equations(
                (*NAMES, *spins), exact.r, np.hstack([exact.jacobian, own]), segment, LAUNCHES * SEGMENTS
            )
            family = Law("side force by spin", spins, "history", mechanism="side_force", each_launch=True)
            return DesignMatrix(equations, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [family])
        if self.smooth:
            return DesignMatrix(
                equations, [], [Law("push by place", columns, "position", switch=partial(_switched, self.launch))]
            )
        return DesignMatrix(equations, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [])


class LinearRegime(Regime):
    """A regime whose problem is a `LinearProblem`; `premises_hold`: whether its premises leave no misfit."""

    name = "glide"
    more_of = "launches of the puck"
    least_size = 5e-4

    def __init__(self, premises_hold: bool = True) -> None:
        self.premises_hold = premises_hold

    def parameters(self, evidence: Evidence, known: Known) -> Mapping[str, float]:
        return DEFAULTS

    def premises(self, evidence: Evidence, known: Known) -> tuple[bool, bool]:
        return True, self.premises_hold

    def parts(self, problem: Problem, evidence: Evidence, known: Known) -> list[RecordingPart]:
        return []

    def mismatch(self, problem: Problem, found: SearchResult) -> Mismatch:
        return mismatch_by_launch(problem, found, self.unit)


NO_EVIDENCE = Evidence((), (), (), (), {})
