"""The leaderboard of the project: every entry holds, and its page is of these entries."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from agents.benchmark.entry import Claim, Entry, read_entry
from agents.benchmark.leaderboard import PAGE, page_of, read_entries
from agents.benchmark.protocol import read_protocol
from agents.benchmark.verify import Finding, verify
from tests.places import ROOT

PROTOCOL, FOLDER = read_protocol(), ROOT / "leaderboard"
ENTRIES = sorted(file.stem for file in FOLDER.glob("*.toml"))


def test_there_are_entries() -> None:
    assert "champion" in ENTRIES


def _failed(entry: Entry) -> list[Finding]:
    return [one for one in verify(entry, PROTOCOL, 40, 20_000_000) if not one.holds]


@pytest.mark.slow
@pytest.mark.parametrize("name", ENTRIES)
def test_every_entry_holds_in_its_drills(name: str) -> None:
    entry = read_entry(FOLDER / f"{name}.toml")
    drills = [claim for claim in entry.claims if not PROTOCOL.tasks[claim.task].is_match]
    assert not _failed(replace(entry, claims=drills))


@pytest.mark.long
@pytest.mark.parametrize("name", ENTRIES)
def test_every_entry_holds(name: str) -> None:
    assert not _failed(read_entry(FOLDER / f"{name}.toml"))


def test_the_page_is_of_these_entries() -> None:
    expected = page_of(read_entries(FOLDER), PROTOCOL)
    assert (FOLDER / PAGE).read_text(encoding="utf-8") == expected, "make it anew: puckpilot benchmark enter writes it"


def _entry(name: str, won: int) -> Entry:
    opponents = PROTOCOL.evaluated_against(PROTOCOL.tasks["match-v0"])
    claims = [Claim("match-v0", one, 200, won, 100) for one in opponents]
    return Entry(name, f"as {name} was", PROTOCOL.hash, {}, claims, Path())


def test_entries_are_ranked_by_points() -> None:
    page = page_of([_entry("a", 20), _entry("b", 40)], PROTOCOL)
    # 20 won and 80 drawn of 200 are 30 %, 40 won and 60 drawn 35 %
    assert page.index("| b | 35.0 | 35.0 | 35.0 | 35.0 | 35.0 |") < page.index("| a | 30.0 | 30.0 |")
    assert "## match-v0" in page and "## attack-v0" not in page and "- **a**: as a was" in page
