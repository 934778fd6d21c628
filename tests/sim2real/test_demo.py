"""The first command that a newcomer runs, on fewer games."""

import json

from PIL import Image

from puckpilot import main
from puckpilot_env.variants import all_variants


def test_it_plays_films_and_compares(tmp_path, capsys):
    assert main(["demo", "follower", "random", "--games", "2", "--out", str(tmp_path), "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert [row["id"] for row in told["meetings"]] == list(all_variants())
    assert all(sum(row["wins"]) + row["draws"] == row["games"] == 2 for row in told["meetings"])
    with Image.open(told["film"]) as film:
        assert (film.format, film.n_frames > 100) == ("GIF", True)  # pyright: ignore[reportAttributeAccessIssue] - has frames
    assert (tmp_path / "match.gif").exists() and len(list(tmp_path.glob("*.png"))) == 1
    assert told["compare"]
