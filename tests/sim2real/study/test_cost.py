"""The cost of a diagnosis is that of the same diagnosis anywhere, and grows with the play."""

from __future__ import annotations

import pytest

from sim2real.study.cost import diagnosis_costs


@pytest.mark.slow
@pytest.mark.long
def test_the_cost_of_a_diagnosis_and_what_it_found() -> None:
    steps: list[tuple[int, int]] = []
    (cost,) = diagnosis_costs([30.0], "table_tilt", 4, lambda done, total: steps.append((done, total)))
    assert steps == [(0, 2), (1, 2)]
    assert cost.play_s == 30.0 and (cost.verdict, cost.mechanisms) == ("missing_physics", ["table_tilt"])
    assert 0.5 < cost.processor_s < 2.5 * cost.clock_s  # two cores at most, and no time of compiling is hidden
    assert 1e8 < cost.peak_bytes < 2e9


def test_an_unknown_mechanism_is_refused_before_anything_is_drawn() -> None:
    with pytest.raises(ValueError, match="unknown mechanism 'tilt': expected one of table_tilt, "):
        list(diagnosis_costs([60.0], "tilt", 4, lambda done, total: None))
