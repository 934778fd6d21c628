"""The committed pages are what the tables say now, complete, and true where play can tell."""

from __future__ import annotations

import ast
import inspect
import re

import numpy as np
import pytest
from PIL import Image

from puckpilot_env import Tables
from puckpilot_env.adapters.parallel_env import TableEnv
from puckpilot_env.documentation import page
from puckpilot_env.documentation.facts import INFOS_AT_END, INFOS_AT_RESET, RECEIVERS, describe
from puckpilot_env.game import reward
from puckpilot_env.game.rules import ENDING_NAMES, RUNNING
from puckpilot_env.game.start import ATTACK, MATCH
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, TABLE
from puckpilot_env.physics.effects import EFFECTS
from puckpilot_env.variants import Variant, all_variants

VARIANTS = list(all_variants().values())
PAGES = {variant.id: (page.FOLDER / f"{variant.module}.md") for variant in VARIANTS}
STALE = f"is not what the tables say now; write the pages anew with `{page.REGENERATE}`"
every_variant = pytest.mark.parametrize("variant", VARIANTS, ids=lambda variant: variant.id)


def _section(text: str, heading: str) -> str:
    return text.partition(f"\n## {heading}\n")[2].partition("\n## ")[0]


def _rows(section: str) -> list[list[str]]:
    """Cells of the body of a section's table."""
    lines = [line for line in section.splitlines() if line.startswith("|")]
    return [[cell.strip() for cell in re.split(r"(?<!\\)\|", line)[1:-1]] for line in lines[2:]]


@every_variant
def test_the_committed_page_is_what_is_written_now(variant: Variant) -> None:
    path = PAGES[variant.id]
    assert path.exists(), f"{path.name} is missing; write the pages anew with `{page.REGENERATE}`"
    assert path.read_text(encoding="utf-8") == page.write_page(variant), f"{path.name} {STALE}"


def test_the_committed_index_is_what_is_written_now() -> None:
    text = (page.FOLDER / "README.md").read_text(encoding="utf-8")
    assert text == page.write_index(VARIANTS), f"README.md {STALE}"
    assert re.findall(r"\]\((\w+)\.md\)", text) == [variant.module for variant in VARIANTS]


def test_no_page_is_left_of_a_variant_that_is_gone() -> None:
    kept = {path.name for path in page.FOLDER.glob("*_v*")}
    assert kept == {f"{variant.module}.{end}" for variant in VARIANTS for end in ("md", "png")}


@pytest.mark.slow
@every_variant
def test_the_picture_shows_a_table(variant: Variant) -> None:
    picture = np.asarray(Image.open(page.FOLDER / f"{variant.module}.png").convert("RGB"))
    height, width, _ = picture.shape
    assert width > 400 and height > 200
    assert picture.std() > 20.0
    assert len(np.unique(picture.reshape(-1, 3), axis=0)) > 100
    assert f"]({variant.module}.png)" in PAGES[variant.id].read_text(encoding="utf-8")


@every_variant
def test_every_column_stands_at_its_index_with_its_bounds(variant: Variant) -> None:
    text = page.write_page(variant)
    tables = Tables(variant, 1)
    observed = [column.name for column in tables.observation_columns]
    for heading, names, bounds in (
        ("Observation", observed, tables.observation_bounds),
        ("Action", ["target_x", "target_y", "volts_x", "volts_y"], tables.action_bounds),
    ):
        rows = _rows(_section(text, heading))
        assert [(int(row[0]), row[1]) for row in rows] == [(i, f"`{name}`") for i, name in enumerate(names)]
        shown = np.array([[float(row[3]), float(row[4])] for row in rows]).T
        np.testing.assert_allclose(shown, bounds, rtol=1e-5)


@every_variant
def test_every_reward_term_is_on_the_pages_where_it_applies(variant: Variant) -> None:
    functions = [node.name for node in ast.parse(inspect.getsource(reward)).body if isinstance(node, ast.FunctionDef)]
    terms = [name for name in functions if name.endswith(("_reward", "_cost"))]
    assert len(terms) >= 7
    assert sorted(RECEIVERS) == sorted(terms), "describe.RECEIVERS says who gets which term, of all terms"
    elsewhere = {"scored_reward", "foul_reward"}
    elsewhere |= {"clear_reward", "possession_lost_reward"} if variant.game == ATTACK else set()
    expected = [name for name in terms if name not in elsewhere or variant.game == MATCH]
    rows = _rows(_section(page.write_page(variant), "Rewards"))
    assert [row[0] for row in rows] == [f"`{name}`" for name in expected]
    assert all(row[1] and re.search(r"-?\d", row[2]) and row[3] for row in rows)


def test_sizes_are_those_of_the_functions() -> None:
    sizes = {entry["name"]: entry["size"] for entry in describe(all_variants()["puckpilot/match-v0"])["rewards"]}
    assert sizes["clear_reward"] == "2"
    assert sizes["conceded_reward"] == "-1"
    assert sizes["shot_reward"] == "at 3 m/s: 0.9 if it would score, 0.18 if it would be saved, 0 if it would miss"
    assert sizes["movement_cost"] == "-0.01 for a way of 0.5 m"
    assert sizes["voltage_cost"] == f"{-10 / 1400:.4g} for 6 V and 8 V"


@every_variant
def test_the_endings_on_the_page_are_those_that_occur(variant: Variant) -> None:
    """Random play on many tables; matches are short, so that both of their endings come up."""
    tables = Tables(variant, 300, seed=3, autoreset=False)
    if variant.game == MATCH:
        tables._rules["match_time"], tables._rules["points"] = 20.0, 1
    random = np.random.default_rng(0)
    low, high = tables.action_bounds
    seen, running = set(), np.ones(len(tables), np.bool_)
    for _ in range(200):
        tables.step(random.uniform(low, high, (len(tables), 2, 4)).astype(np.float32))
        ended = running & (tables.states["ending"] != RUNNING)
        seen |= {ENDING_NAMES[ending] for ending in tables.states["ending"][ended]}
        running &= ~ended
    listed = describe(variant)["endings"]
    assert seen == set(listed)
    assert all(f"`{name}`" in _section(page.write_page(variant), "Endings") for name in listed)


@every_variant
def test_infos_are_those_on_the_page(variant: Variant) -> None:
    env = TableEnv(variant, max_cycles=1)
    _, at_reset = env.reset(seed=0)
    at_end = env.step({agent: env.action_space(agent).sample() for agent in env.agents})[4]
    assert list(at_end["player_0"]) == [name for name, _ in INFOS_AT_END]
    assert list(at_reset["player_1"]) == ([name for name, _ in INFOS_AT_RESET] if variant.draws else [])
    section = _section(page.write_page(variant), "Infos")
    assert re.findall(r"^- `(\w+)`:", section, re.M) == [*at_reset["player_0"], *at_end["player_0"]]


@every_variant
def test_parameters_and_draws_are_all_there(variant: Variant) -> None:
    text = page.write_page(variant)
    rows = _rows(_section(text, "Parameters"))
    assert [row[0] for row in rows] == [f"`{row.name}`" for row in TABLE if row not in EFFECT_ROWS]
    nominal = Tables(variant, 1).nominal
    for row, name in zip(rows, (row.name for row in TABLE if row not in EFFECT_ROWS), strict=True):
        assert float(re.split(r"[ ,]", row[2])[0]) == pytest.approx(float(nominal[name][0]), rel=1e-5)
    drawn = _rows(_section(text, "Drawn for every episode"))
    assert [row[0] for row in drawn] == [f"`{draw.parameter}`" for draw in variant.draws]
    assert all(row[1] == BY_NAME[row[0].strip("`")].unit and row[2] and row[5] for row in drawn)
    for row, draw in zip(drawn, variant.draws, strict=True):
        assert (float(row[3]), float(row[4])) == (draw.low, draw.high)


@every_variant
def test_effects_and_their_numbers_are_all_there(variant: Variant) -> None:
    rows = _rows(_section(page.write_page(variant), "Effects"))
    simulated = {name: effect for name, effect in EFFECTS.items() if not effect.not_simulated}
    assert [row[0] for row in rows] == [f"`{name}`" for name in simulated]
    for row, effect in zip(rows, simulated.values(), strict=True):
        assert row[1] == effect.regime and row[2]
        shown = list(effect.rows.items())
        for short, number in shown if effect.listed else [shown[0], shown[1], shown[-1]]:
            assert f"`{short}`" in row[3] and f"`{number.name}`" in row[3] and f"[{number.unit}]" in row[3]


@pytest.mark.slow
@every_variant
def test_the_snippets_run(variant: Variant, capsys: pytest.CaptureFixture[str]) -> None:
    snippets = re.findall(r"```python\n(.*?)```", page.write_page(variant), re.S)
    assert len(snippets) == 5
    for snippet in snippets:
        exec(snippet, {})
    assert capsys.readouterr().out.startswith(f"(256, 2, {len(describe(variant)['observation'])}) ")
