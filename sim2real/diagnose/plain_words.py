"""Mechanisms, numbers and counts in plain words."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable

from puckpilot_env.physics.effects import MODULES
from sim2real.diagnose.finding import Account, Estimate

FAULTS = {  # of the camera that are parameters of the simulator and no effects
    "camera_delay": "The camera's frames are stamped late: each shows the table as it was delay_s before its stamp.",
    "held_frames": "The camera repeats itself: some frames show the last position again in place of a new one.",
}
LEAST_P = 1e-300  # no chance is told to be smaller
LAUNCH = ("launch", "launches")
PIECES = {"gantry": ("stretch of some seconds", "stretches of some seconds")}


def explained(mechanism: str) -> str:
    """A mechanism in a sentence or two; "" for one that has no words of its own."""
    told = FAULTS.get(mechanism) or (MODULES[mechanism].__doc__ if mechanism in MODULES else "") or ""
    return " ".join(told.strip().split("\n\n")[0].split())


def clause(mechanism: str) -> str:
    """The gist of it, to stand within a sentence; "" as above."""
    gist = re.split(r"[.:;,]( |$)", explained(mechanism))[0]
    return gist[:1].lower() + gist[1:]


def with_gist(mechanism: str) -> str:
    """The mechanism's name with its gist in brackets."""
    gist = clause(mechanism)
    return f"{mechanism} ({gist})" if gist else mechanism


def unit_words(unit: str) -> str:
    """A unit as print has it; "" for a pure number."""
    return "" if unit == "1" else re.sub(r"\^([23])", lambda power: "²³"[int(power[1]) - 2], unit)


def digits_of(one: Estimate) -> tuple[str, str, str]:
    """Value, low and high to as many digits as tell them apart, and at least four."""
    half, size = 0.5 * (one.high - one.low), max(abs(one.value), abs(one.low), abs(one.high))
    digits = 4
    if math.isfinite(half) and half > 0.0:
        digits = max(digits, math.ceil(math.log10(size / half)) + 1)
    value, low, high = (f"{number:.{min(digits, 12)}g}" for number in (one.value, one.low, one.high))
    return value, low, high


def chance(p: float) -> str:
    """A p-value with its sign of relation."""
    return f"p < {LEAST_P:.0e}" if p <= LEAST_P else f"p = {p:.1e}"


def counted(number: int, one: str, many: str) -> str:
    """A count with its noun."""
    return f"{number} {one if number == 1 else many}"


def are_weights(names: Iterable[str]) -> bool:
    """Whether numbers of these names are the weights of a law's shapes, of which none means anything by itself."""
    return all(re.fullmatch(r"c\d+", name) for name in names)


def left_over(many: float) -> str:
    """How much is left, in a clause; `many` times what noise alone leaves."""
    return f"{many:.2g} times what noise alone makes is left"


def piece(regime: str) -> str:
    """What a regime's recording is cut into, for fits and for the proof."""
    return PIECES.get(regime, LAUNCH)[0]


def piece_words(regime: str) -> str:
    """What is kept apart in a regime, in the plural."""
    return PIECES.get(regime, LAUNCH)[1]


def pieces(account: Account) -> str:
    """How many untouched pieces a regime was tried on."""
    assert account.proof is not None
    return counted(account.proof.pieces, *PIECES.get(account.regime, LAUNCH))
