"""Smooth laws without a formula, in words: their names say what acts and what it depends on."""

from __future__ import annotations

import re

WHAT = {
    "force": "an extra force",
    "loss": "an extra loss of speed",
    "pull": "more or less pull of the motors than their volts give",
    "restitution": "another restitution",
    "tangential ratio": "another share kept of the speed along the contact",
    "share kept": "another share kept of the speed, against the wall or mallet and along it",
    "side force": "a force across the velocity",
}
BY = {
    "place": "the place",
    "speed": "the speed",
    "volts": "the commanded volts",
    "time": "the time",
    "heading": "the direction of motion",
    "angle": "the angle of the contact",
    "place along the table": "the place along the table",
    "place across the table": "the place across the table",
    "history": "the volts and the speed of the last second",
    "each launch's spin": "the spin that each launch begins with, a number a launch",
}


def shape_in_words(name: str) -> str:
    """A sentence on the smooth law of this name; "" where the name says no such law."""
    parts = re.fullmatch(r"(?:mallet's )?(.+) by (.+)", name)
    if parts is None or parts[1] not in WHAT or parts[2] not in BY:
        return ""
    return f"It is {WHAT[parts[1]]}, whose size is a smooth curve of {BY[parts[2]]}."
