"""A regime small enough to check by hand: residuals that are linear in its parameters, and white noise."""

from collections.abc import Mapping, Sequence
from functools import partial

import numpy as np

from sim2real.diagnose.engine import gram
from sim2real.diagnose.engine.law import Law
from sim2real.diagnose.problem import Columns, Residuals, Units

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
    plain: tuple[str, ...] = base
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

    def columns(self, values: Mapping[str, float], free: Sequence[str], use: np.ndarray | None) -> Columns:
        """See `Problem.columns`."""
        exact = self.residuals(values, NAMES, np.arange(LAUNCHES))
        piece = np.repeat(np.arange(LAUNCHES * PIECES), EACH)
        grams = gram.make_grams(NAMES, exact.r, exact.jacobian, piece, LAUNCHES * PIECES)
        columns = ("tilt_x", "tilt_y")
        if self.spinning:
            own = exact.jacobian[:, NAMES.index("spin"), None] * (self.launch[:, None] == np.arange(LAUNCHES))
            spins = tuple(f"spin {k}" for k in range(LAUNCHES))
            grams = gram.make_grams(
                (*NAMES, *spins), exact.r, np.hstack([exact.jacobian, own]), piece, LAUNCHES * PIECES
            )
            family = Law("side force by spin", spins, "history", mechanism="side_force", each_launch=True)
            return Columns(grams, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [family])
        if self.likeness:
            return Columns(
                grams, [], [Law("push by place", columns, "position", switch=partial(_switched, self.launch))]
            )
        return Columns(grams, [Law("table_tilt", columns), Law("linear_drag", ("linear_drag",))], [])
