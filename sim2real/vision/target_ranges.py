"""The ranges of what a user says of the tracked objects: the options of `puckpilot track`, and a table's file."""

from __future__ import annotations

RANGES = {  # by the fields of `Targets`
    "puck_radius": (0.005, 0.1, "metres"),
    "ring_height": (0.0, 0.3, "metres"),
    "level": (1.0, 250.0, "a grey level"),
}


def target_number(field: str, value: float, name: str, given: str, others: str = "") -> float:
    """The `value` of a field of `Targets`. ValueError, in one line, if it is out of range, by the `name` under which
    and the words in which it was `given`; `others`: what else could have been given."""
    low, high, unit = RANGES[field]
    if not low <= value <= high:
        raise ValueError(f"{name} is {given}; expected {others}{unit} from {low:g} to {high:g}")
    return value
