"""Smooth laws without a formula, in words derived from their names."""

from __future__ import annotations

import re

WHAT = {
    "force": "an extra force",
    "loss": "an extra loss of speed",
    "pull": "a deviation of the motors' force from the one that the volts predict",
    "restitution": "a change of the restitution",
    "tangential ratio": "a change of the tangential speed ratio of contacts",
    "share kept": "a change of the speed ratio of contacts, normal and tangential alike",
    "side force": "a force across the velocity",
}
BY = {
    "place": "the position",
    "speed": "the speed",
    "volts": "the commanded volts",
    "time": "the time",
    "heading": "the direction of motion",
    "angle": "the angle of the contact",
    "place along the table": "the position along the table",
    "place across the table": "the position across the table",
    "history": "the volts and the speed of the last second",
    "each launch's spin": "the initial spin of each launch",
}


def shape_in_words(name: str) -> str:
    """Return a sentence on the smooth law of this name; "" for any other name."""
    parts = re.fullmatch(r"(?:mallet's )?(.+) by (.+)", name)
    if parts is None or parts[1] not in WHAT or parts[2] not in BY:
        return ""
    return f"It is {WHAT[parts[1]]}, whose size is a smooth function of {BY[parts[2]]}."
