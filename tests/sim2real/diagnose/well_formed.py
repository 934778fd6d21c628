"""A checker of the format puckpilot-diagnosis/1, independent of the code that writes diagnosis.json."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

VERDICTS = {"agrees", "parameters_only", "missing_physics", "undetermined"}
REGIMES = {"glide", "wall", "corner", "mallet", "gantry", "sensing"}
DEPENDS = {"position", "speed", "heading", "time", "history", "command"}
MECHANISMS = {
    "table_tilt", "table_warp", "linear_drag", "friction_patch", "air_drift", "friction_anisotropy", "side_force",
    "speed_dependent_restitution", "tangential_restitution", "wall_friction_spin", "wall_to_wall_restitution",
    "wall_alignment",
    "corner_restitution", "mallet_speed_restitution", "mallet_friction", "mallet_give", "voltage_sag", "motor_deadband",
    "motor_friction", "command_delay", "belt_compliance", "backlash", "camera_delay", "clock_drift", "scale_error",
    "held_frames", "stamp_jitter", "unlisted",
}  # fmt: skip
SIZES = ("before_m", "after_m", "floor_m", "pieces")


def faults(printed: dict[str, Any]) -> list[str]:
    """Return the faults of a diagnosis, a line each."""
    found = printed.get("findings")
    if printed.get("format") != "puckpilot-diagnosis/1" or not isinstance(found, list):
        return ["no diagnosis of this format"]
    wrong = [] if printed.get("verdict") in VERDICTS else [f"verdict {printed.get('verdict')!r}"]
    if (printed.get("verdict") == "missing_physics") != bool(found):
        wrong.append("verdict and findings disagree")
    numbers = dict(printed.get("baseline", {}).get("parameters", {}))
    for one in found:
        wrong += _faults(one)
        numbers |= one.get("parameters", {})
    wrong += [f"{name} is no value between low and high, with a unit" for name, n in numbers.items() if not _whole(n)]
    proof = printed.get("heldout")
    if found and not (proof and all(isinstance(proof.get(name), int | float) for name in SIZES)):
        wrong.append("findings without a held-out proof")
    return wrong if isinstance(printed.get("next_recording"), str) else [*wrong, "no next_recording"]


def _faults(one: dict[str, Any]) -> Iterator[str]:
    names = [one.get("mechanism"), *one.get("also_possible", ["?"])]
    yield from (f"mechanism {name!r}" for name in names if name not in MECHANISMS)
    yield from (f"depends_on {word!r}" for word in one.get("depends_on", ["?"]) if word not in DEPENDS)
    if one.get("regime") not in REGIMES:
        yield f"regime {one.get('regime')!r}"
    if one.get("mechanism") == "unlisted" and not one.get("depends_on"):
        yield "unlisted, and depends on nothing"
    if not (isinstance(one.get("p_value"), float) and 0.0 <= one["p_value"] <= 1.0):
        yield f"p_value {one.get('p_value')!r}"
    if not {"before", "after", "unit"} <= set(one.get("heldout", {})):
        yield "a finding without before and after"


def _whole(number: dict[str, Any]) -> bool:
    return bool(number.get("unit")) and number["low"] <= number["value"] <= number["high"]
