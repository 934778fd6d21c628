"""The result of a diagnosis as data: estimates, findings, and the result of each regime."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from sim2real.diagnose.tuned import RESIDUALS


def explained(before: float, after: float) -> float:
    """Return the share of the excess variance over the noise that a law explains, 0 if there is no excess.

    `before`, `after`: rms residuals without and with the law, in units of the noise.
    """
    return (before**2 - after**2) / (before**2 - 1.0) if before > 1.0 else 0.0


def times_the_noise(times: float) -> str:
    """Return a residual in units of the noise as words with two significant digits, or whole numbers."""
    return f"{times:.0f} times the noise" if times > 99.5 else f"{times:.2g} times the noise"


@dataclass(frozen=True)
class Estimate:
    """A fitted parameter with its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Proof:
    """Residuals on `pieces` held-out launches (of the gantry: segments of some seconds): rms [m] before and after, and
    `floor_m`, the rms of noise alone."""

    before_m: float
    after_m: float
    floor_m: float
    pieces: int


@dataclass(frozen=True)
class Alternative:
    """A mechanism that was not chosen: the increase `loss` of the cross-validation loss, and the reason."""

    mechanism: str
    loss: float
    reason: str


@dataclass(frozen=True)
class Curve:
    """A law as a curve: `y` over `x` with a 95 % band, each (n,), and binned data (m,) with standard errors.

    `ticks`: names of x = 0, 1, … if x is categorical. `formula` (n,): values of a readable formula for a smooth law.
    """

    x_label: str
    y_label: str
    x: np.ndarray
    y: np.ndarray
    low: np.ndarray
    high: np.ndarray
    data_x: np.ndarray
    data_y: np.ndarray
    data_error: np.ndarray
    ticks: tuple[str, ...] = ()
    formula: np.ndarray | None = None


@dataclass(frozen=True)
class Mismatch:
    """Where recording and simulator differ: residuals, measured minus predicted, of n items (`of`, in the plural).

    `before`, `after` (n, c) in `unit`: under the refitted baseline and under the final law; `std` (n, c): their
    standard deviation from sensor noise; `components`: their c names; `by`: coordinates (n,) by label with unit. On a
    table of `size` (2,) [m], `place` (n, 2) [m] and `axis` (n, 2), the unit vector of the first component; the second
    component points to its left. These are None if the items have no place.
    """

    of: str
    what: str
    unit: str
    components: tuple[str, ...]
    before: np.ndarray
    after: np.ndarray
    std: np.ndarray
    by: Mapping[str, np.ndarray]
    place: np.ndarray | None = None
    axis: np.ndarray | None = None
    size: tuple[float, float] | None = None


@dataclass(frozen=True)
class SensorSummary:
    """The sensor in one recording.

    `noise_m`, `clock_s`: white noise of position [m] and time stamp [s]; `correlation_time_s`: of the errors [s], 0 if
    they are white; `place_std_m`: position error that the calibration states [m]; `dropped`, `repeated`, `outliers`:
    shares of all frames; then counts of launches, glides, contacts and unexplained events.
    """

    recording: str
    seconds: float
    frames: int
    noise_m: float
    clock_s: float
    correlation_time_s: float
    place_std_m: float
    dropped: float
    repeated: float
    outliers: float
    launches: int
    glides: int
    contacts: int
    unexplained: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class NullControl:
    """A control of a proof that contains no law by construction.

    `before`, `after`: rms residuals as of a finding; `named`: the number `of` drawn controls in which a search selected
    a law, None if no search was made.
    """

    before: float
    after: float
    named: int | None = None
    of: int | None = None


@dataclass(frozen=True)
class Finding:
    """One missing effect, in the terms of the format puckpilot-diagnosis/1.

    `values`: the simulator's parameters that switch it on, by their names in `puckpilot_env.parameters`; `ranges`: the
    fitted ones with intervals. `null_controls`: residuals before and after in null controls, by name
    (`engine.null_controls`). `size_m`: size of the effect [m] (`effect_size`).
    """

    regime: str
    mechanism: str
    also_possible: tuple[str, ...]
    depends_on: tuple[str, ...]
    formula: str
    parameters: Mapping[str, Estimate]
    p_value: float
    before: float | None = None  # rms of holdout residuals in units of the sensor's noise; None without data
    after: float | None = None
    where: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)
    ranges: Mapping[str, Estimate] = field(default_factory=dict)
    alternatives: tuple[Alternative, ...] = ()
    curve: Curve | None = None
    null_controls: Mapping[str, NullControl] = field(default_factory=dict)
    size_m: float | None = None


@dataclass(frozen=True)
class RegimeResult:
    """The result of one regime. `undetermined`: the reason why there is no conclusion, "" if there is one.

    `baseline`: the refitted parameters of the baseline law; `defaults`: whether the default parameters fit as well.
    `selection`: cross-validation residuals of launches; `proof`: residuals on the holdout, which nothing else here
    uses. `better`: whether the refitted parameters predict launches better than the defaults. `doubt`: an inconclusive
    law, "" if there is none; `minor`: laws too small to report. `misfit`: whether no law explains the residuals.
    """

    regime: str
    findings: tuple[Finding, ...]
    baseline: Mapping[str, Estimate]
    defaults: bool
    selection: Proof | None
    undetermined: str = ""
    next_recording: str = ""
    mismatch: Mismatch | None = None
    doubt: str = ""
    misfit: bool = False
    better: bool = False
    minor: str = ""
    proof: Proof | None = None

    @property
    def verdict(self) -> str:
        """The verdict, as of a diagnosis, of this regime alone."""
        if self.findings:
            return "missing_physics"
        if self.undetermined or self.misfit:
            return "undetermined"
        return "agrees" if self.defaults else "parameters_only"

    @property
    def times_noise(self) -> float | None:
        """The rms cross-validation residual divided by the noise, None without data.

        All choices and statements on the quality of fit use it; none uses the holdout.
        """
        one = self.selection
        return None if one is None or not one.floor_m or not one.pieces else one.after_m / one.floor_m

    @property
    def unexplained(self) -> str:
        """The remaining cross-validation residual in words, "" if it is not large."""
        times = self.times_noise
        if self.undetermined or self.selection is None or times is None or times < RESIDUALS.large:
            return ""
        return f"the remaining residual is {1e3 * self.selection.after_m:.2g} mm, {times_the_noise(times)}"
