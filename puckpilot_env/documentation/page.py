"""The documentation page of a variant, in Markdown, written from its module's docstring and the tables alone.

Pages are kept in `puckpilot_env/pages/`; `puckpilot envs --write-pages` writes them anew.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path
from typing import Any

from puckpilot_env.documentation.facts import describe
from puckpilot_env.variants import Variant, all_variants

FOLDER = Path(__file__).parents[1] / "pages"
REGENERATE = "puckpilot envs --write-pages"
DRAWS = (
    'Option `draws="draws.toml"`: other ranges, and of more parameters (see `puckpilot_env/options/draws_file.py`); '
    "one that is given is not drawn."
)

USAGE = """\
## Usage

PettingZoo, both players at once:

```python
import pettingzoo
import puckpilot_env

env = pettingzoo.make("parallel", "{id}")
observations, infos = env.reset(seed=0)
while env.agents:
    actions = {{agent: env.action_space(agent).sample() for agent in env.agents}}
    observations, rewards, terminations, truncations, infos = env.step(actions)
env.close()
```

PettingZoo, one player after the other:

```python
import pettingzoo
import puckpilot_env

env = pettingzoo.make("aec", "{id}")
env.reset(seed=0)
for agent in env.agent_iter():
    observation, reward, termination, truncation, info = env.last()
    over = termination or truncation
    env.step(None if over else env.action_space(agent).sample())
env.close()
```

The same environments from the variant's own module, with their options:

```python
from puckpilot_env import {module}

env = {module}.parallel_env(render_mode="rgb_array", max_cycles=20, parameters={{"friction": 0.2}})
env.reset(seed=0)
picture = env.render()  # (height, width, 3) uint8
```

Gymnasium, one seat against a scripted player:

```python
import gymnasium
import puckpilot_env

env = gymnasium.make("{id}", opponent="goalie")
observation, info = env.reset(seed=0)
observation, reward, terminated, truncated, info = env.step(env.action_space.sample())
env.close()
```

Many tables at once, without any adapter:

```python
import numpy as np
from puckpilot_env import Tables

tables = Tables("{id}", 256, seed=0)
low, high = tables.action_bounds
random = np.random.default_rng(0)
for _ in range(10):
    tables.step(random.uniform(low, high, (256, 2, 4)).astype(np.float32))
print(tables.observations.shape, tables.rewards.mean())
```
"""


def write_page(variant: Variant) -> str:
    """The page of a variant in Markdown."""
    facts = describe(variant)
    sections = (
        _head(facts, variant.module),
        USAGE.format(id=facts["id"], module=variant.module),
        _spaces(facts),
        _rewards(facts),
        _endings_and_timing(facts),
        _parameters(facts),
        _draws(facts),
        _effects(facts),
        _infos(facts),
        _history(facts),
    )
    return "\n".join(sections)


def write_index(variants: Iterable[Variant]) -> str:
    """The page that leads to the others."""
    rows = [
        (f"[`{v.id}`]({v.module}.md)", v.summary, len(facts["observation"]), f"{v.period:g} s", v.ending)
        for v in variants
        for facts in [describe(v)]
    ]
    return (
        f"# Environments\n\nWritten by `{REGENERATE}`; do not edit.\n\n"
        + _table(("id", "what", "observation", "step", "ending"), rows)
        + "\nEvery id is registered with PettingZoo (`parallel` and `aec`: two players) and with Gymnasium (one seat "
        "against a scripted player).\nA version is kept for good: a change of rules, spaces or defaults is a new id.\n"
    )


def write_pages(folder: Path = FOLDER) -> list[Path]:
    """Write the page and the picture of every variant, and the index, into `folder`; returns the files."""
    from PIL import Image

    from puckpilot_env.rendering.drawing import draw_start

    folder.mkdir(parents=True, exist_ok=True)
    files = []
    for variant in all_variants().values():
        page, picture = folder / f"{variant.module}.md", folder / f"{variant.module}.png"
        page.write_text(write_page(variant), encoding="utf-8")
        Image.fromarray(draw_start(variant)).save(picture, optimize=True)
        files += [page, picture]
    index = folder / "README.md"
    index.write_text(write_index(all_variants().values()), encoding="utf-8")
    return [*files, index]


def _table(headings: Sequence[str], rows: Iterable[Sequence[object]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    cells = ([str(cell).replace("|", "\\|") for cell in line] for line in lines)
    return "".join(f"| {' | '.join(line)} |\n" for line in cells)


def _head(facts: dict[str, Any], module: str) -> str:
    prose = f"\n{facts['prose']}\n" if facts["prose"] else ""
    return (
        f"<!-- Written by `{REGENERATE}`; do not edit. -->\n# {facts['title']}\n\n"
        f"`{facts['id']}`: {facts['summary']}\n\n![{facts['id']}: how an episode may begin]({module}.png)\n{prose}"
    )


def _spaces(facts: dict[str, Any]) -> str:
    headings = ("index", "name", "unit", "low", "high", "meaning")
    columns = {
        space: _table(
            headings,
            [
                (i, f"`{c['name']}`", c["unit"], f"{c['low']:g}", f"{c['high']:g}", c["meaning"])
                for i, c in enumerate(facts[space])
            ],
        )
        for space in ("observation", "action")
    }
    return (
        f"## Observation\n\n`Box`, ({len(facts['observation'])},) float32, for each player, in its own frame: origin "
        f"at its right-hand corner,\nx forward, y to the left. Sensing: {facts['sensing']}.\n\n{columns['observation']}"
        f"\n## Action\n\n`Box`, ({len(facts['action'])},) float32, for each player, in its own frame. A number outside "
        f"the space is an error.\n\n{columns['action']}"
    )


def _rewards(facts: dict[str, Any]) -> str:
    rows = [(f"`{r['name']}`", r["meaning"], r["size"], r["receiver"]) for r in facts["rewards"]]
    return (
        "## Rewards\n\nThe sum of these terms, each a function of `puckpilot_env/game/reward.py`, which cites the "
        "report's appendix J.\n\n"
        + _table(("term", "what for", "size", "who, when"), rows)
        + f'\nOption `reward="sparse"`: in place of all of these {facts["sparse_rewards"]}.\n'
    )


def _endings_and_timing(facts: dict[str, Any]) -> str:
    limit, period = facts["step_limit"], facts["period"]
    limited = f"{limit} steps ({limit * period:g} s), then truncation" if limit else "none"
    names = ", ".join(f"`{name}`" for name in facts["endings"])
    return (
        f"## Endings\n\n{facts['ending']}\n\nNames in `infos`: {names}"
        + ("" if limit else "; `step limit` with the option `max_cycles`")
        + f".\n\n## Timing\n\n- A step lasts {period:g} s (option `period`, from 1/120 s on).\n"
        f"- Step limit: {limited} (option `max_cycles`).\n"
    )


def _parameters(facts: dict[str, Any]) -> str:
    drawn = {draw["parameter"] for draw in facts["draws"]}
    rows = []
    for p in facts["parameters"]:
        changed = "" if p["default"] == p["usual"] else f" (elsewhere {p['usual']:g})"
        default = f"{p['default']:g}{changed}{', drawn' if p['name'] in drawn else ''}"
        rows.append((f"`{p['name']}`", p["unit"], default, f"{p['low']:g} to {p['high']:g}", p["meaning"], p["source"]))
    return "## Parameters\n\nOption `parameters={name: value}`; a value outside the range is an error.\n\n" + _table(
        ("name", "unit", "default", "range", "meaning", "source"), rows
    )


def _draws(facts: dict[str, Any]) -> str:
    text = "## Drawn for every episode\n\n"
    if not facts["draws"]:
        return text + f"Nothing; every table is the same. {DRAWS}\n"
    draws = [
        (f"`{d['parameter']}`", d["unit"], d["distribution"], f"{d['low']:g}", f"{d['high']:g}", d["source"])
        for d in facts["draws"]
    ]
    return f"{text}{DRAWS}\n\n" + _table(("parameter", "unit", "distribution", "low", "high", "source"), draws)


def _effects(facts: dict[str, Any]) -> str:
    def number(n: dict[str, Any]) -> str:
        parameter = "" if n["name"] == n["short"] else f" (`{n['name']}`)"
        return f"`{n['short']}`{parameter} [{n['unit']}] {n['low']:g} to {n['high']:g}"

    def numbers(e: dict[str, Any]) -> str:
        found = [number(n) for n in e["numbers"]]
        return ", ".join(found if e["listed"] else [*found[:2], "…", found[-1]])  # a table is too long to print

    rows = [(f"`{e['name']}`", e["regime"], e["law"], numbers(e)) for e in facts["effects"]]
    return (
        "## Effects\n\nPhysics that the baseline leaves out; what is not drawn is off. Option "
        "`effects={effect: {number: value}}`,\nor a file's name. A number is a parameter too, by the name in "
        "brackets.\n\n" + _table(("effect", "where", "law", "numbers"), rows)
    )


def _infos(facts: dict[str, Any]) -> str:
    def listed(entries: dict[str, str]) -> str:
        return "".join(f"- `{name}`: {meaning}\n" for name, meaning in entries.items()) or "Nothing.\n"

    return (
        f"## Infos\n\nAt reset, for each player:\n\n{listed(facts['infos_at_reset'])}\n"
        f"At the last step of an episode, for each player:\n\n{listed(facts['infos_at_end'])}"
    )


def _history(facts: dict[str, Any]) -> str:
    return "## Version history\n\n" + "".join(f"- {line}\n" for line in facts["history"])
