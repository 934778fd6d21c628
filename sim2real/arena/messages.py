"""What a page may send, checked, and what the server sends, as JSON."""

from __future__ import annotations

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from sim2real.arena.game import Place, View

MOST_CHARACTERS = 256  # of what a page says
FARTHEST = 10.0  # m that a pointer may be from the table's corner


@dataclass(frozen=True)
class Aim:
    """A person's pointer is at x, y [m]; `sent`: the page's clock [ms]."""

    x: float
    y: float
    sent: float


@dataclass(frozen=True)
class Ping:
    """A page asks how long an answer takes; `sent`: its clock [ms]."""

    sent: float


@dataclass(frozen=True)
class Again:
    """A page asks for another match."""


Said = Aim | Ping | Again
KINDS: dict[str, type[Said]] = {"aim": Aim, "ping": Ping, "again": Again}


def parse(text: str) -> Said:
    """What a page said. ValueError, in one line, for anything else."""
    if len(text) > MOST_CHARACTERS:
        raise ValueError(f"a message of {len(text)} characters; expected {MOST_CHARACTERS} at most")
    try:
        content = json.loads(text)
    except (ValueError, RecursionError):
        raise ValueError("a message that is not JSON") from None
    kind = content.pop("kind", None) if isinstance(content, dict) else None
    found = KINDS.get(kind) if isinstance(kind, str) else None
    if found is None:
        raise ValueError(f"a message without a kind of {', '.join(KINDS)}")
    names = set(found.__dataclass_fields__)
    if set(content) != names or not all(_is_number(value) for value in content.values()):
        raise ValueError(f"a message of kind {kind}; expected the numbers {', '.join(sorted(names)) or 'none'}")
    if found is Aim and max(abs(content["x"]), abs(content["y"])) > FARTHEST:
        raise ValueError(f"an aim at {content['x']:g}, {content['y']:g}; expected {FARTHEST:g} m at most")
    return found(**content)


def _is_number(value: Any) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def encode(kind: str, **content: Any) -> str:
    """A message to a page."""
    return json.dumps({"kind": kind, **content}, separators=(",", ":"), allow_nan=False)


def welcome(p: np.void, names: Sequence[str], again: bool, **own: Any) -> str:
    """What a page needs to know before the first state of a match: the table's sizes, of its parameters, who plays, and
    whether it may ask for another match; own: what it knows besides who plays, and not who looks on."""
    table = {name: float(p[name]) for name in ("length", "width", "goal_width", "puck_radius", "mallet_radius")}
    return encode("welcome", names=list(names), table=table, again=again, **{"seat": None, **own})


def state(view: View, followed: Mapping[str, Any]) -> str:
    """What there is to see; followed: of a person's mallet, see `seats.PersonChair.followed`, or nothing."""
    return encode(
        "state", time=round(view.time, 4), puck=_rounded(view.puck), mallets=[_rounded(one) for one in view.mallets],
        score=view.score, left=round(view.left, 1), ending=view.ending, **followed,
    )  # fmt: skip


def _rounded(place: Place | None) -> list[float] | None:
    """To a tenth of a millimetre."""
    return None if place is None else [round(place[0], 4), round(place[1], 4)]
