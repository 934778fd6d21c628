"""The regimes that a recording does not test, and the missing data."""

from __future__ import annotations

from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.regimes.registry import REGIMES

NO_PUCK = "no camera frame shows a puck (frames.csv)"
NO_PATH = "the robot's mallet was not recorded (mallet.csv)"
LACKS = {name: regime.lacks for name, regime in REGIMES.items() if regime.lacks}  # where a camera saw a puck


def untested(diagnosis: Diagnosis) -> dict[str, str]:
    """Return the missing data by regime, for regimes that were not tested; {} if the diagnosis has no result."""
    if not diagnosis.regime_results:
        return {}
    tested = {each.regime for each in diagnosis.regime_results}
    path = "gantry" in tested
    if not any(seen.frames and seen.dropped < 1.0 for seen in diagnosis.sensor_summaries):
        found = dict.fromkeys(("sensing", *LACKS), NO_PUCK)
    else:
        found = {regime: why for regime, why in LACKS.items() if regime not in tested}
        if "mallet" in found and not path:
            found["mallet"] = NO_PATH
    return found if path else {**found, "gantry": NO_PATH}
