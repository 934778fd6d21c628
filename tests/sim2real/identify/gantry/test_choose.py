"""A step is kept for what it predicts, not for what it fits."""

from __future__ import annotations

import numpy as np
import pytest

from sim2real.identify.gantry.choose import Tried, judged
from sim2real.identify.gantry.identify import identify_gantry, profile_of
from sim2real.identify.gantry.law import as_shipped
from sim2real.identify.gantry.text import lines
from tests.sim2real.identify.gantry.simulated import KNOWN, RADIUS, log

BEFORE = np.outer([4.0, 5.0, 4.5, 6.0], [1e-3, 2e-3])


@pytest.mark.parametrize(
    ("factors", "kept"),
    [
        ([0.9, 0.92, 0.88, 0.9], True),
        ([0.99, 0.985, 0.99, 0.985], False),  # less than 2 %
        ([0.7, 1.2, 0.8, 1.15], False),  # better and worse: luck
        ([1.0, 1.0, 1.0, 1.0], False),
        ([1.3, 1.3, 1.3, 1.3], False),
    ],
)
def test_a_step_is_kept_if_its_gain_is_more_than_slight_and_than_luck(factors: list[float], kept: bool) -> None:
    law = as_shipped(RADIUS)
    new = judged(Tried(law, "x", BEFORE * np.array(factors)[:, None]), Tried(law, "y", BEFORE))
    assert new.kept == kept and new.gain == pytest.approx(1.0 - np.mean(factors))


@pytest.mark.slow
def test_of_a_single_log_friction_is_found_and_sag_is_not_claimed() -> None:
    stages: list[str] = []
    found = identify_gantry([log(7, 6.0, push=0.1)], [], lambda stage, share: stages.append(stage))
    assert "friction_motors" in found.chosen.law.steps and "sag" not in found.chosen.law.steps
    assert found.chosen.law.values["friction_left"] == pytest.approx(KNOWN["friction_left"], abs=0.15)
    assert stages[-1] == "intervals"
    text = "\n".join(lines(found))
    assert "5 parts in time of the only recording, each predicted by the fit to the others" in text
    assert "sag of the supply" in text and "dropped, not claimed" in text
    profile = profile_of(found)
    assert profile.recordings == ("log_7",) and len(profile.laws[profile.chosen].rms) == 5
    worst = max(max(rms) for rms in profile.laws["third_order"].rms.values())
    assert worst > max(max(rms) for rms in profile.laws[profile.chosen].rms.values())
