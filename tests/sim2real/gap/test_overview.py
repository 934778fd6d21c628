"""Several circles together: means over seeds, shares of the ceiling by hand, what cannot be compared is refused."""

from __future__ import annotations

import json
from contextlib import nullcontext
from pathlib import Path
from typing import Any, cast

import numpy as np
import pytest

from puckpilot import main
from sim2real.gap.overview import overview, read_circle
from sim2real.gap.report import circle_words
from sim2real.gap.report.overview_page import overview_page
from sim2real.gap.report.overview_words import overview_lines
from sim2real.gap.stages import LAST, STAGES, Work

GAMES, MINUTES = 30, 1.0


def played(net: float, spread: float, seed: int) -> dict[str, Any]:
    """Games of a minute whose net scores have this mean exactly, and differ from game to game."""
    noise = np.random.default_rng(seed).normal(0.0, spread, GAMES)
    scores = net + noise - noise.mean()
    return {"net": {"value": net}, "games": [[float(one), 0, 60.0 * MINUTES, "goalie"] for one in scores]}


def circle(table: str, seed: int, before: float, spread: float = 0.3, **arms: float) -> dict[str, Any]:
    return {
        "format": "puckpilot-gap/7",
        "conditions": {
            "player": "policy:champion", "opponents": ["goalie"], "backend": "twin", "table": table, "games": GAMES,
            "seconds": 60.0, "recorded": 5, "minutes": 30.0, "steps": None, "seed": seed,
        },
        "simulator": {"scored": 5.0, "conceded": 1.0},
        "in_simulator": {
            name: {"unchanged": {"scored": 5.0, "conceded": 1.0}, "truth": {"scored": 2.0 * net, "conceded": 0.5}}
            for name, net in {"before": before, **arms}.items()
        },
        "before": played(before, spread, seed),
        "found": ["table_tilt"],
        "arms": {arm: played(net, spread, seed + 10 * k + 1) for k, (arm, net) in enumerate(arms.items())},
    }  # fmt: skip


def test_changes_and_shares_are_means_over_the_seeds() -> None:
    """Won back: 1 and 2 of the ceiling's 2 and 2."""
    one = circle("walls", 0, 1.0, corrected=2.0, truth=3.0)
    other = circle("walls", 1000, 2.0, corrected=4.0, truth=4.0)
    result = overview([one, other])["tables"]["walls"]
    assert (result["seeds"], result["simulator"], result["before"]) == ([0, 1000], 4.0, 1.5)
    corrected, truth = result["arms"]["corrected"], result["arms"]["truth"]
    assert corrected["change"]["value"] == pytest.approx(1.5) and truth["change"]["value"] == pytest.approx(2.0)
    assert corrected["share"]["value"] == pytest.approx(0.75)
    assert corrected["share"]["low"] < 0.75 < corrected["share"]["high"]
    assert truth["own_better_by"]["value"] == pytest.approx(-0.5)
    assert corrected["of_seeds"] == pytest.approx([1.0, 2.0]) and corrected["simulated"] == pytest.approx(3.0)
    assert "share" not in truth and "own_better_by" not in corrected


def test_tables_on_which_an_arm_is_better_are_counted() -> None:
    """Than `unchanged` on two of three, but by next to nothing on one of them; the control does not count."""
    circles = [
        circle("none", 0, 6.0, corrected=8.0, unchanged=2.0),
        circle("walls", 0, 1.0, corrected=4.0, unchanged=1.0),
        circle("warp", 0, 1.0, corrected=2.01, unchanged=2.0),
        circle("late", 0, 1.0, corrected=2.0, unchanged=4.0, truth=3.0),
    ]
    for of_player in circles[3]["in_simulator"].values():
        del of_player["truth"]  # of a late table the simulator has nothing
    result = overview(circles)
    late = result["tables"]["late"]["arms"]
    assert late["corrected"]["simulated"] is None and "late, corrected" in overview_page(result, ["out/late"])
    assert result["own_better_on"] == {
        "unchanged": {"tables": 3, "better": 2, "clearly": 1, "simulated": 2, "in_simulator": 2},
        "truth": {"tables": 1, "better": 0, "clearly": 0, "simulated": 0, "in_simulator": 0},
    }
    lines = overview_lines(result)
    assert "corrected wins back more than unchanged on 2 of 3 tables, on 1 beyond the interval" in lines
    walls = next(line for line in lines if line.startswith("walls"))
    assert "4.00    1.00" in walls and "+3.00 (" in walls and "+0.00 (" in walls


def test_over_all_tables_the_control_is_left_out() -> None:
    """Won back: 1 and 3 of the ceiling's 2 and 4; on the control 4 of 0 are lost."""
    circles = [
        circle("none", 0, 6.0, corrected=2.0, truth=6.0),
        circle("walls", 0, 1.0, corrected=2.0, truth=3.0),
        circle("late", 0, 1.0, corrected=4.0, truth=5.0, unchanged=1.0),
    ]
    arms = overview(circles)["all"]
    assert arms.keys() == {"corrected", "truth"}
    assert arms["corrected"]["change"]["value"] == pytest.approx(2.0)
    assert arms["corrected"]["share"]["value"] == pytest.approx(2.0 / 3.0)


def test_without_a_ceiling_above_chance_there_is_no_share() -> None:
    row = overview([circle("warp", 0, 1.0, 3.0, corrected=1.4, truth=1.2)])["tables"]["warp"]["arms"]["corrected"]
    assert row["share"] is None


def test_an_interval_over_seeds_is_narrower_and_holds_the_truth() -> None:
    """Of 60 pairs of series whose true change is 1, nearly all hold it."""
    held, widths = 0, []
    for trial in range(60):
        series = []
        for seed in (3 * trial, 1000 + 3 * trial):
            rng = np.random.default_rng(seed)
            made = circle("late", seed, 0.0, corrected=0.0)
            for games, mean in ((made["before"], 1.0), (made["arms"]["corrected"], 2.0)):
                games["games"] = [[float(one), 0, 60.0, "goalie"] for one in rng.normal(mean, 1.0, GAMES)]
            series.append(made)
        both = overview(series)["tables"]["late"]["arms"]["corrected"]["change"]
        alone = overview(series[:1])["tables"]["late"]["arms"]["corrected"]["change"]
        held += both["low"] <= 1.0 <= both["high"]
        widths.append((both["high"] - both["low"]) / (alone["high"] - alone["low"]))
    assert held >= 52 and np.mean(widths) == pytest.approx(np.sqrt(0.5), abs=0.06)


def test_the_command_writes_the_page(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    for name, made in (("a", circle("walls", 0, 1.0, corrected=2.0, truth=3.0)), ("b", circle("late", 0, 1.0))):
        (tmp_path / name).mkdir()
        (tmp_path / name / "gap.json").write_text(json.dumps(made))
    folders = [str(tmp_path / name) for name in "ab"]
    assert main(["gap", "--together", *folders, "--out", str(tmp_path / "all")]) == 0
    html = (tmp_path / "all" / "overview.html").read_text(encoding="utf-8")
    assert "walls, corrected" in html and "50 %" in html and "late: commands and a camera that are late" in html
    result = json.loads((tmp_path / "all" / "overview.json").read_text())
    assert list(result["tables"]) == ["walls", "late"]
    capsys.readouterr()
    assert main(["gap", "--together", folders[0], folders[0], "--out", str(tmp_path / "all")]) == 2
    assert capsys.readouterr().err.strip().endswith("share games: 30 games need seeds as far from each other")


def test_the_command_goes_round_several_tables_and_writes_a_page_over_them(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    seen = []

    def report(work: Work) -> None:
        table = work.folder.conditions.table
        seen.append((work.folder.path.name, work.folder.shared))
        (work.folder.path / "gap.json").write_text(json.dumps(circle(table, 0, 1.0, corrected=2.0)))

    monkeypatch.setattr(circle_words, "circle_lines", lambda result: [])
    for name in STAGES:
        monkeypatch.setitem(cast(dict, STAGES), name, report if name == LAST else lambda work: None)
    tables = ["--table", "walls", "--table", "late"]
    assert main(["gap", "goalie", *tables, "--arms", "corrected", "--out", str(tmp_path)]) == 0
    shared = tmp_path / "of_any_table"
    assert seen == [("walls", shared), ("late", shared)]
    assert list(json.loads((tmp_path / "overview.json").read_text())["tables"]) == ["walls", "late"]
    assert "overview.html" in capsys.readouterr().out.splitlines()[-1]


@pytest.mark.parametrize(
    ("content", "reason"),
    [
        (None, "has no gap.json: expected the --out of a puckpilot gap that is done"),
        ("{", "is no result of puckpilot gap"),
        ('{"format": "puckpilot-gap/9"}', "is no result of puckpilot gap: expected the format puckpilot-gap/7"),
    ],
)
def test_what_is_no_circle_is_refused(tmp_path: Path, content: str | None, reason: str) -> None:
    if content is not None:
        (tmp_path / "gap.json").write_text(content)
    with pytest.raises(ValueError, match=reason):
        read_circle(tmp_path)


def test_a_share_of_a_ceiling_that_is_hardly_above_chance_is_a_number() -> None:
    """Goals of games of a minute."""
    rng = np.random.default_rng(2)
    known = 0
    for seed in range(40):
        made = circle("late", 100 * seed, 0.0, corrected=0.0, truth=0.0)
        for games, mean in ((made["before"], 2.0), (made["arms"]["corrected"], 2.4), (made["arms"]["truth"], 3.0)):
            games["games"] = [[int(one), 0, 60.0, "goalie"] for one in rng.poisson(mean, GAMES)]
        row = overview([made])["tables"]["late"]["arms"]["corrected"]["share"]
        if row is not None:
            known += 1
            assert np.isfinite(row["low"]) and row["low"] <= row["value"] <= row["high"]
    assert 10 < known < 40


@pytest.mark.parametrize(
    ("seed", "arms", "reason"),
    [(29, {"corrected": 2.0}, "share games"), (30, {"corrected": 2.0}, None), (30, {"truth": 2.0}, "different arms")],
)
def test_circles_of_one_table_have_the_same_arms_and_no_games_in_common(
    seed: int, arms: dict[str, float], reason: str | None
) -> None:
    both = [circle("late", 0, 1.0, corrected=2.0), circle("late", seed, 1.0, **arms)]
    with nullcontext() if reason is None else pytest.raises(ValueError, match=reason):
        overview(both)


def test_circles_of_other_conditions_are_refused() -> None:
    other = circle("late", 0, 1.0)
    other["conditions"]["minutes"] = 5.0
    with pytest.raises(ValueError, match=r"circles of different minutes cannot be compared: 30\.0, 5\.0"):
        overview([circle("walls", 0, 1.0), other])
