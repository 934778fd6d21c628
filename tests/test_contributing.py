"""The recipes of CONTRIBUTING.md, followed to the letter on a copy of the packages, in a fresh interpreter."""

from __future__ import annotations

import json
import math
import os
import re
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

from tests.places import ROOT

pytestmark = pytest.mark.slow

BLOCK = re.compile(
    r"^```python\n# (?P<path>\S+\.py)(?:, (?P<how>after|instead of) `(?P<mark>[^\n]+)`)?\n(?P<body>.*?)^```",
    re.M | re.S,
)

READ = """
import json
import puckpilot_env
from baselines import player_names
from puckpilot_env import Tables, all_variants, find_variant, parameters
from puckpilot_env.documentation.page import write_page
from puckpilot_env.kernel import kernel
import pettingzoo

VARIANT = "puckpilot/match-small-goals-v0"

def refusal(**values):
    try:
        Tables(VARIANT, 1, parameters=values)
    except ValueError as error:
        return str(error)

@kernel
def read(p):
    return 2.0 * p.face_off_speed

print(json.dumps({
    "home": puckpilot_env.__file__,
    "players": player_names(),
    "ids": list(all_variants()),
    "aec": VARIANT in pettingzoo.aec_registry,
    "page": write_page(find_variant(VARIANT)),
    "refusal": refusal(face_off_speed=9.0),
    "doubled": read(parameters.make_records(1, {"face_off_speed": 1.25})[0]),
}))
"""

PLAY = """
import json
import numpy as np
import pettingzoo
from baselines import Seat, make_player
from puckpilot_env import Tables

WIND = {"wind": {"wind": 2.0, "pull": 0.1}}  # of all tables, so that one kernel is compiled
VARIANT = "puckpilot/match-small-goals-v0"

def speeds(**values):
    tables = Tables(VARIANT, 50, seed=1, parameters=values, effects=WIND)
    return np.hypot(tables.states["puck"]["vx"], tables.states["puck"]["vy"]).tolist()

env = pettingzoo.make("parallel", VARIANT, parameters={"face_off_speed": 0.5}, effects=WIND)
tables = Tables(VARIANT, 3, seed=1, effects=WIND)
shadow = make_player("shadow", Seat.from_tables(tables))
seen, before = tables.observations.copy(), tables.observations[:, 0, 1].copy()
for _ in range(5):
    tables.step(np.stack([shadow.act(tables.observations[:, 0]), shadow.act(tables.observations[:, 1])], axis=1))
windy = Tables("match-v0", 1, effects=WIND, parameters={"friction": 0.0, "drag": 0.0})
windy.states["puck"][0] = (1.2, 0.3, 0.0, 0.0, 0.0, 0, (0, 0))
stay = np.concatenate([windy.observations[:, :, :2], np.full((1, 2, 2), 0.3, np.float32)], axis=2)
windy.step(stay)
gust = np.array([windy.states["puck"][0]["vx"], windy.states["puck"][0]["vy"]])
column = {column.name: i for i, column in enumerate(tables.observation_columns)}
print(json.dumps({
    "first action": shadow.act(seen[:, 0])[0].tolist(),
    "opponent_y": float(seen[0, 0, column["opponent_y"]]),
    "mallet_x": tables.observations[:, 0, column["mallet_x"]].tolist(),
    "agents": sorted(env.reset(seed=0)[0]),
    "goal_width": float(env.unwrapped.tables.params[0]["goal_width"]),
    "usual": speeds(),
    "slow": speeds(face_off_speed=0.3),
    "wind": gust.tolist(),
}))
"""


def _follow(root: Path) -> list[str]:
    """Do what every code block with a path says, in `root`; returns the paths."""
    done = []
    for block in BLOCK.finditer((ROOT / "CONTRIBUTING.md").read_text(encoding="utf-8")):
        path, mark, body = root / block["path"], block["mark"], block["body"]
        if block["how"] is None:
            assert not path.exists(), f"CONTRIBUTING.md adds {block['path']}, which there is already"
            path.write_text(body, encoding="utf-8")
        else:
            text = path.read_text(encoding="utf-8")
            assert text.count(mark) == 1, (
                f"CONTRIBUTING.md: `{mark}` stands {text.count(mark)} times in {block['path']}"
            )
            if block["how"] == "after":
                end = text.index("\n", text.index(mark)) + 1
                path.write_text(text[:end] + body + text[end:], encoding="utf-8")
            else:
                path.write_text(text.replace(mark, body.strip()), encoding="utf-8")
        done.append(block["path"])
    return done


def _run(root: Path, name: str, script: str) -> dict[str, Any]:
    """What a fresh interpreter prints that runs a script on the copy in `root`."""
    environment = {**os.environ, "PYTHONPATH": str(root), "XDG_CACHE_HOME": str(root / "cache")}
    file = root / name  # kernels need one
    file.write_text(script, encoding="utf-8")
    done = subprocess.run([sys.executable, str(file)], cwd=root, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return json.loads(done.stdout.splitlines()[-1])


@pytest.fixture(scope="module")
def copy(tmp_path_factory: pytest.TempPathFactory) -> tuple[Path, list[str]]:
    """A copy of the packages on which all recipes have been followed, and the paths of these."""
    root = tmp_path_factory.mktemp("copy")
    for package in ("puckpilot_env", "baselines"):
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("__pycache__", "pages"))
    return root, _follow(root)


@pytest.fixture(scope="module")
def facts(copy: tuple[Path, list[str]]) -> dict[str, Any]:
    """What is known of the copy before anything is played."""
    return _run(copy[0], "read_recipes.py", READ)


@pytest.fixture(scope="module")
def games(copy: tuple[Path, list[str]]) -> dict[str, Any]:
    """What comes of playing on the copy, whose simulator is compiled anew for that."""
    return _run(copy[0], "play_recipes.py", PLAY)


def test_every_recipe_was_followed_on_the_copy(copy: tuple[Path, list[str]], facts: dict[str, Any]) -> None:
    root, recipes = copy
    assert recipes == [
        "baselines/players/shadow.py",
        "puckpilot_env/match_small_goals_v0.py",
        "puckpilot_env/parameters.py",
        "puckpilot_env/game/start.py",
        "puckpilot_env/physics/effects/wind.py",
    ]
    assert Path(facts["home"]).is_relative_to(root)


def test_all_that_is_new_is_found_and_on_the_page(facts: dict[str, Any]) -> None:
    assert "shadow" in facts["players"]
    assert "puckpilot/match-small-goals-v0" in facts["ids"] and facts["aec"]
    page = facts["page"]
    assert "# Match with small goals: only a well-aimed shot goes in\n" in page
    assert "All else is as in `puckpilot/match-v0`." in page
    assert "| `goal_width` | m | 0.2 (elsewhere 0.32) |" in page
    assert "| `face_off_speed` | m/s | 0.8 | 0.3 to 3 | highest speed of the puck at a face-off |" in page
    wind = "| `wind` | glide | a = pull (wind - v_x) along x | `wind` [m/s] -20 to 20, `pull` (`wind_pull`)"
    assert wind in page


def test_the_new_parameter_is_refused_and_read(facts: dict[str, Any]) -> None:
    assert facts["refusal"] == "parameter 'face_off_speed' is 9.0; expected a number in [0.3, 3] m/s"
    assert facts["doubled"] == 2.5


@pytest.mark.long
def test_the_new_player_plays(games: dict[str, Any]) -> None:
    x, y = games["first action"][:2]
    assert x == pytest.approx(0.2) and y == pytest.approx(games["opponent_y"])
    assert all(x == pytest.approx(0.2, abs=0.02) for x in games["mallet_x"]), "after half a second it is where it wants"


@pytest.mark.long
def test_the_new_variant_is_played(games: dict[str, Any]) -> None:
    assert games["agents"] == ["player_0", "player_1"]
    assert games["goal_width"] == 0.2


@pytest.mark.long
def test_the_new_parameter_sets_face_offs(games: dict[str, Any]) -> None:
    assert all(speed == pytest.approx(0.3) for speed in games["slow"])
    assert 0.3 <= min(games["usual"]) < 0.5 < max(games["usual"]) <= 0.8


@pytest.mark.long
def test_the_new_effect_blows(games: dict[str, Any]) -> None:
    """v = wind (1 - exp(-pull t)) after the 0.1 s of a step."""
    assert games["wind"] == pytest.approx([2.0 * (1.0 - math.exp(-0.01)), 0.0], abs=1e-7)
