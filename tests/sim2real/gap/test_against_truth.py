"""What was named beside what is there, by hand, and what a silent diagnosis leaves to learn on."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from sim2real.gap.against_truth import MISSED, NAMED, NOT_THERE, POSSIBLE, against_truth, learnt
from sim2real.gap.gap_table import TWIN, find_gap_table
from sim2real.gap.report.found_words import against_line, against_rows, found_words, learnt_words
from sim2real.table.twin.concealed import TABLES

SILENT_EFFECTS = """format = "puckpilot-effects/1"
[parameters]
length = 2.0
friction = 0.11
"""
SILENT_DRAWS = """format = "puckpilot-draws/1"
[parameters]
friction = 0.11
[draws.friction]
low = 0.1
high = 0.12
"""


def finding(mechanism: str, regime: str = "gantry", also: tuple[str, ...] = (), **numbers: float) -> dict[str, Any]:
    parameters = {name: {"value": one, "low": one - 1e-3, "high": one + 1e-3} for name, one in numbers.items()}
    return {"mechanism": mechanism, "regime": regime, "also_possible": list(also), "parameters": parameters}


def outcomes(findings: list[dict[str, Any]], table: str) -> dict[str, str]:
    return {one["effect"]: one["outcome"] for one in against_truth(findings, TABLES[table])}


def test_what_is_named_stands_beside_the_truth() -> None:
    made_up = finding("backlash", width=0.002)
    rows = against_truth([finding("command_delay", delay_s=0.0052), made_up], TABLES["late"])
    assert [(one["effect"], one["outcome"]) for one in rows] == [
        ("command_delay", NAMED), ("camera_delay", MISSED), ("backlash", NOT_THERE),
    ]  # fmt: skip
    number = rows[0]["numbers"]["delay_s"]
    assert number["truth"] == 0.005 and number["found"]["value"] == 0.0052 and number["unit"] == "s"
    assert rows[1]["numbers"]["delay_s"] == {"unit": "s", "truth": 0.015, "found": None}
    assert against_line(rows) == "named: command_delay; missed: camera_delay; not there: backlash"
    assert against_rows(rows)[0] == ["command_delay", NAMED, "delay_s [s]", "0.0052", "0.0042 to 0.0062", "0.005"]


def test_all_numbers_of_an_effect_that_was_found_are_shown_and_no_others() -> None:
    """Of walls that spin, inertia and decay are as the simulator's; a restitution is no number of the effect."""
    walls = finding("speed_dependent_restitution", "wall", slope=0.09, e0=0.7)
    rows = {
        one["effect"]: one
        for one in against_truth([walls, finding("wall_friction_spin", "wall", mu=0.2)], TABLES["walls"])
    }
    assert rows["wall_friction_spin"]["numbers"].keys() == {"mu"}
    assert rows["speed_dependent_restitution"]["numbers"].keys() == {"slope"}


def test_laws_without_a_name_are_held_against_those_of_their_regime() -> None:
    assert outcomes([finding("unlisted", "glide")], "unlisted") == {"unlisted, glide": NAMED}
    assert outcomes([finding("unlisted", "wall")], "unlisted") == {
        "unlisted, glide": MISSED,
        "unlisted, wall": NOT_THERE,
    }


def test_another_possibility_is_neither_named_nor_missed() -> None:
    found = [finding("air_drift", "glide", ("table_tilt",))]
    assert outcomes(found, "warp") == {"table_tilt": POSSIBLE, "table_warp": MISSED, "air_drift": NOT_THERE}


@pytest.mark.parametrize("table", TABLES)
def test_every_concealed_table_has_something_to_miss(table: str) -> None:
    assert bool(against_truth([], TABLES[table])) == (table != "none") and set(outcomes([], table).values()) <= {MISSED}


def test_of_a_silent_diagnosis_constants_and_draws_are_learnt(tmp_path: Path) -> None:
    (tmp_path / "diagnosis").mkdir()
    (tmp_path / "diagnosis" / "effects.toml").write_text(SILENT_EFFECTS)
    (tmp_path / "diagnosis" / "draws.toml").write_text(SILENT_DRAWS)
    made = learnt(tmp_path, find_gap_table(TWIN, "none"))
    assert made == {"effects": [], "constants": {"friction": 0.11}, "draws": {"friction": [0.1, 0.12]}}
    words = learnt_words(made)
    assert "effects switched on: none" in words and "friction 0.11;" in words and "friction 0.1 to 0.12." in words
    for verdict in ("agrees", "parameters_only", "undetermined"):
        begins = "It cannot tell: " if verdict == "undetermined" else "Nothing: "
        assert found_words({"found": [], "verdict": verdict, "open": {}}).startswith(begins)
