"""What a diagnosis says, as data: estimates, findings, and the account that each regime gives of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

TO_THE_NOISE = 1.3  # times what noise alone leaves, up to which residuals are called noise
MUCH = 3.0  # times the noise, and what is left is worth a word


def explained(before: float, after: float) -> float:
    """Share of what residuals of rms `before`, in units of the noise, have beyond noise, that is gone `after`; 0 where
    they are noise."""
    return (before**2 - after**2) / (before**2 - 1.0) if before > 1.0 else 0.0


@dataclass(frozen=True)
class Estimate:
    """A fitted number with its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Proof:
    """Residuals on pieces that no fit ever saw: rms [m] before and after, and what noise alone leaves."""

    before_m: float
    after_m: float
    floor_m: float
    pieces: int


@dataclass(frozen=True)
class Alternative:
    """A mechanism that was tried and not chosen: how much worse it foretells held-out pieces, and why it lost."""

    mechanism: str
    loss: float
    reason: str


@dataclass(frozen=True)
class Curve:
    """A law as a picture: `y` over `x` with a 95 % band, each (n,), and the binned data (m,) with its standard errors.

    `ticks` are names for x = 0, 1, …, where it counts things. `formula` (n,): a readable formula beside a smooth law.
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
    """Where recording and simulator part: what each of `n` things (`of`, in the plural) has more than a law foretells,
    seen less foretold.

    `before`, `after` (n, c) in `unit`, under the refitted baseline and under the final law; `std` (n, c): what the
    sensor's noise makes of them; `components`: their `c` names. `by`: what they may depend on, label with unit to (n,).
    On a table of `size` (2,) [m], `place` (n, 2) [m] and `axis` (n, 2), the unit vector of the first component, of
    which the second is to the left; None where the pieces have no place.
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
    """What the sensor gave in one recording: `noise_m`, `clock_s` as in `sensor.Noise`; `memory_s`, for which errors
    hang together (0 where they do not); `place_std_m`, by which the calibration says that it has all places wrong;
    shares of all frames."""

    recording: str
    seconds: float
    frames: int
    noise_m: float
    clock_s: float
    memory_s: float
    place_std_m: float
    dropped: float
    held: float
    wild: float
    launches: int
    glides: int
    contacts: int
    unexplained: int
    notes: tuple[str, ...] = ()


@dataclass(frozen=True)
class NullControl:
    """A control of a proof, in which nothing is to be found: rms residuals as a finding's, before and after, and in how
    many `of` so many drawn twins a search `named` something, None where that would tell nothing."""

    before: float
    after: float
    named: int | None = None
    of: int | None = None


@dataclass(frozen=True)
class Finding:
    """One missing piece of physics, in the words of the format puckpilot-diagnosis/1.

    `values`: the simulator's parameters that switch it on, by their names in `puckpilot_env.parameters`; `ranges`:
    those fitted, with intervals. `null_controls`: the same residuals before and after in controls where nothing is to
    be found, by the control's name (`engine.null_controls`). `size_m`: by how much it moves things (`effect_size`).
    """

    regime: str
    mechanism: str
    also_possible: tuple[str, ...]
    depends_on: tuple[str, ...]
    formula: str
    parameters: Mapping[str, Estimate]
    p_value: float
    before: float | None = None  # rms of held-out residuals in units of the sensor's noise; None where there are none
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
    """What one regime of the recording says. `undetermined` gives the reason why it cannot tell, "" if it can.

    `baseline`: the refitted parameters of the baseline law; `defaults`: whether the simulator's own numbers do as well.
    `selection`: residuals of launches, each predicted by laws fitted to others; `proof`: of data
    that nothing else here depends on. `better`: whether the refitted numbers predict launches better than the
    simulator's own. `doubt`: what the data hint at without telling it surely, "" where nothing; `minor`: what is there
    and too small to matter. `misfit`: whether no law explains it.
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
        """As a diagnosis's, of this regime alone."""
        if self.findings:
            return "missing_physics"
        if self.undetermined or self.misfit:
            return "undetermined"
        return "agrees" if self.defaults else "parameters_only"

    @property
    def times_noise(self) -> float | None:
        """What laws leave of launches not fitted to, over what noise alone would; None where nothing was tried.
        Every choice and every word on how well laws fit rests on it, and none on the proof."""
        one = self.selection
        return None if one is None or not one.floor_m or not one.pieces else one.after_m / one.floor_m

    @property
    def unexplained(self) -> str:
        """How much more than noise the laws leave of launches, in words; "" where hardly any is."""
        times = self.times_noise
        if self.undetermined or self.selection is None or times is None or times < MUCH:
            return ""
        return f"{1e3 * self.selection.after_m:.2g} mm stay unexplained, {times:.2g} times the noise"
