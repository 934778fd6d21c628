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

SCRIPT = """
import json
import numpy as np
import pettingzoo
import puckpilot_env
from baselines import Seat, make_player, player_names
from puckpilot_env import Tables, all_variants, find_variant, parameters
from puckpilot_env.kernel import kernel
from puckpilot_env.documentation.page import write_page

WIND = {"wind": {"wind": 2.0, "pull": 0.1}}  # of all tables, so that one kernel is compiled

def speeds(**values):
    tables = Tables(VARIANT, 50, seed=1, parameters=values, effects=WIND)
    return np.hypot(tables.states["puck"]["vx"], tables.states["puck"]["vy"]).tolist()

def refusal(**values):
    try:
        Tables(VARIANT, 1, parameters=values)
    except ValueError as error:
        return str(error)

@kernel
def read(p):
    return 2.0 * p.face_off_speed

VARIANT = "puckpilot/match-small-goals-v0"
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
    "home": puckpilot_env.__file__,
    "players": player_names(),
    "first action": shadow.act(seen[:, 0])[0].tolist(),
    "opponent_y": float(seen[0, 0, column["opponent_y"]]),
    "mallet_x": tables.observations[:, 0, column["mallet_x"]].tolist(),
    "ids": list(all_variants()),
    "aec": VARIANT in pettingzoo.aec_registry,
    "agents": sorted(env.reset(seed=0)[0]),
    "goal_width": float(env.unwrapped.tables.params[0]["goal_width"]),
    "page": write_page(find_variant(VARIANT)),
    "usual": speeds(),
    "slow": speeds(face_off_speed=0.3),
    "refusal": refusal(face_off_speed=9.0),
    "wind": gust.tolist(),
    "doubled": read(parameters.make_records(1, {"face_off_speed": 1.25})[0]),
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


@pytest.fixture(scope="module")
def facts(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Any]:
    """What a fresh interpreter finds once all recipes have been followed."""
    root = tmp_path_factory.mktemp("copy")
    for package in ("puckpilot_env", "baselines"):
        shutil.copytree(ROOT / package, root / package, ignore=shutil.ignore_patterns("__pycache__", "pages"))
    recipes = _follow(root)
    environment = {**os.environ, "PYTHONPATH": str(root), "XDG_CACHE_HOME": str(root / "cache")}
    script = root / "try_recipes.py"  # kernels need a file
    script.write_text(SCRIPT, encoding="utf-8")
    done = subprocess.run([sys.executable, str(script)], cwd=root, env=environment, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    return {"root": root, "recipes": recipes, **json.loads(done.stdout.splitlines()[-1])}


def test_every_recipe_was_followed_on_the_copy(facts: dict[str, Any]) -> None:
    assert facts["recipes"] == [
        "baselines/players/shadow.py",
        "puckpilot_env/match_small_goals_v0.py",
        "puckpilot_env/parameters.py",
        "puckpilot_env/game/start.py",
        "puckpilot_env/physics/effects/wind.py",
    ]
    assert Path(facts["home"]).is_relative_to(facts["root"])


def test_the_new_player_is_found_and_plays(facts: dict[str, Any]) -> None:
    assert "shadow" in facts["players"]
    x, y = facts["first action"][:2]
    assert x == pytest.approx(0.2) and y == pytest.approx(facts["opponent_y"])
    assert all(x == pytest.approx(0.2, abs=0.02) for x in facts["mallet_x"]), "after half a second it is where it wants"


def test_the_new_variant_is_registered_and_has_a_page(facts: dict[str, Any]) -> None:
    assert "puckpilot/match-small-goals-v0" in facts["ids"] and facts["aec"]
    assert facts["agents"] == ["player_0", "player_1"]
    assert facts["goal_width"] == 0.2
    page = facts["page"]
    assert "# Match with small goals: only a well-aimed shot goes in\n" in page
    assert "All else is as in `puckpilot/match-v0`." in page
    assert "| `goal_width` | m | 0.2 (elsewhere 0.32) |" in page


def test_the_new_parameter_is_accepted_refused_read_and_on_the_page(facts: dict[str, Any]) -> None:
    assert all(speed == pytest.approx(0.3) for speed in facts["slow"])
    assert 0.3 <= min(facts["usual"]) < 0.5 < max(facts["usual"]) <= 0.8
    assert facts["refusal"] == "parameter 'face_off_speed' is 9.0; expected a number in [0.3, 3] m/s"
    assert facts["doubled"] == 2.5
    assert "| `face_off_speed` | m/s | 0.8 | 0.3 to 3 | highest speed of the puck at a face-off |" in facts["page"]


def test_the_new_effect_blows_and_is_on_the_page(facts: dict[str, Any]) -> None:
    """v = wind (1 - exp(-pull t)) after the 0.1 s of a step."""
    assert facts["wind"] == pytest.approx([2.0 * (1.0 - math.exp(-0.01)), 0.0], abs=1e-7)
    assert (
        "| `wind` | glide | a = pull (wind - v_x) along x | `wind` [m/s] -20 to 20, `pull` (`wind_pull`)"
        in facts["page"]
    )
