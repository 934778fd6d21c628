"""The first command that a newcomer runs, on fewer games."""

import json

import pytest
from PIL import Image

from puckpilot import main
from puckpilot_env.variants import all_variants

pytestmark = pytest.mark.slow


def test_it_plays_films_compares_and_names_what_the_bundled_recording_lacks(tmp_path, capsys):
    assert main(["demo", "follower", "random", "--games", "2", "--out", str(tmp_path), "--json"]) == 0
    expected = json.loads(capsys.readouterr().out)
    assert [row["id"] for row in expected["meetings"]] == list(all_variants())
    for row in expected["meetings"]:
        assert row["games"] == 2
        if row["id"].startswith("puckpilot/match"):
            assert sum(row["wins"]) + row["draws"] == 2 and len(row["fouls"]) == 2
        else:  # a drill: each player's own episode, and nothing that adds up both
            assert "wins" not in row and [role["tested"] for role in row["tested"]] == ["follower", "random"]
            assert [sum(end["count"] for end in role["endings"].values()) for role in row["tested"]] == [1, 1]
    with Image.open(expected["film"]) as film:
        assert (film.format, film.n_frames > 100) == ("GIF", True)  # pyright: ignore[reportAttributeAccessIssue] - has frames
    assert (tmp_path / "match.gif").exists() and len(list(tmp_path.glob("*.png"))) == 1
    assert expected["compare"]
    assert [one["mechanism"] for one in expected["diagnose"]["findings"]] == ["table_tilt", "wall_friction_spin"]
    assert (tmp_path / "diagnosis" / "report.html").exists()
