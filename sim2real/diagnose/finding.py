"""What a diagnosis says, as data: estimates, findings, and the account that each regime gives of a recording."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np


@dataclass(frozen=True)
class Estimate:
    """A fitted number with its 95 % interval."""

    value: float
    low: float
    high: float
    unit: str


@dataclass(frozen=True)
class Proof:
    """Residuals on pieces that no fit ever saw: rms [m] before and after, and what the sensor's noise alone leaves."""

    before_m: float
    after_m: float
    floor_m: float
    pieces: int


@dataclass(frozen=True)
class Rival:
    """A mechanism that was tried and not chosen: how much worse it foretells held-out launches, and why it lost."""

    mechanism: str
    loss: float
    reason: str


@dataclass(frozen=True)
class Curve:
    """A law as a picture: `y` over `x` with a 95 % band, each (n,), and the binned data (m,) with its errors."""

    x_label: str
    y_label: str
    x: np.ndarray
    y: np.ndarray
    low: np.ndarray
    high: np.ndarray
    data_x: np.ndarray
    data_y: np.ndarray
    data_error: np.ndarray


@dataclass(frozen=True)
class Finding:
    """One missing piece of physics, in the words of the format puckpilot-diagnosis/1.

    `values`: the simulator's parameters that switch it on, by their names in `puckpilot_env.parameters`.
    """

    regime: str
    mechanism: str
    also_possible: tuple[str, ...]
    depends_on: tuple[str, ...]
    formula: str
    parameters: Mapping[str, Estimate]
    p_value: float
    before: float  # rms of held-out residuals in units of the sensor's noise
    after: float
    where: Mapping[str, Any] = field(default_factory=dict)
    values: Mapping[str, float] = field(default_factory=dict)
    rivals: tuple[Rival, ...] = ()
    curve: Curve | None = None


@dataclass(frozen=True)
class Account:
    """What one regime of the recording says. `undetermined` gives the reason why it cannot tell, "" if it can.

    `baseline`: the refitted parameters of the baseline law; `shipped`: whether the simulator's own numbers do as well.
    """

    regime: str
    findings: tuple[Finding, ...]
    baseline: Mapping[str, Estimate]
    shipped: bool
    proof: Proof | None
    undetermined: str = ""
    next_recording: str = ""
