"""Which regimes a recording says nothing about, and what it would take."""

from __future__ import annotations

from sim2real.diagnose.diagnosis import Diagnosis

NO_PUCK = "no camera frame shows a puck (frames.csv)"
NO_PATH = "the robot's mallet was not recorded (mallet.csv)"
LACKS = {  # of a regime without an account beside a camera that saw a puck
    "glide": "no free slide of the puck was seen",
    "wall": "too few free slides to tell bounces by",
    "mallet": "no blow of the robot's mallet was seen",
}


def untested(diagnosis: Diagnosis) -> dict[str, str]:
    """What is missing, by the regimes that were not tested at all; {} where nothing could be said anyway."""
    if not diagnosis.accounts:
        return {}
    there = {each.regime for each in diagnosis.accounts}
    path = "gantry" in there
    if not any(seen.frames and seen.dropped < 1.0 for seen in diagnosis.sights):
        found = dict.fromkeys(("sensing", *LACKS), NO_PUCK)
    else:
        found = {regime: why for regime, why in LACKS.items() if regime not in there}
        if "mallet" in found and not path:
            found["mallet"] = NO_PATH
    return found if path else {**found, "gantry": NO_PATH}
