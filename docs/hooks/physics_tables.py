"""MkDocs hook: the pages of all parameters and all effects, written from their tables."""

from __future__ import annotations

from collections.abc import Iterable, Sequence

from mkdocs.config.defaults import MkDocsConfig
from mkdocs.structure.files import File, Files

from puckpilot_env.effect import Effect, Parameter
from puckpilot_env.parameters import EFFECT_ROWS, TABLE
from puckpilot_env.physics.effects import EFFECTS

PARAMETERS_HEAD = """\
# Parameters

Written from `puckpilot_env/parameters.py`.

Every physical number of the baseline. Give one with `parameters={"friction": 0.09}` where an environment is made, or
with `--set friction=0.09` in a shell; a value outside its range is an error. The numbers of [effects](effects.md) are
parameters too.

"""
EFFECTS_HEAD = """\
# Effects

Written from the files of `puckpilot_env/physics/effects/`.

An effect is physics that a table may have beyond the baseline. It is off while its numbers are at their defaults.
Give one with `effects={"table_tilt": {"tilt_y": 0.02}}`, or with a file: `--effects effects.toml`. The diagnosis looks
for these effects by name, but for tables of numbers that hold any law.

"""


def on_files(files: Files, config: MkDocsConfig) -> Files:
    """Add both pages."""
    files.append(File.generated(config, "reference/parameters.md", content=write_parameters()))
    files.append(File.generated(config, "reference/effects.md", content=write_effects()))
    return files


def write_parameters() -> str:
    """The baseline's parameters as one table."""
    beyond = {row.name for row in EFFECT_ROWS}
    rows = [(f"`{row.name}`", *_numbers(row), row.meaning, row.source) for row in TABLE if row.name not in beyond]
    return PARAMETERS_HEAD + _table(("name", "unit", "default", "range", "meaning", "source"), rows)


def write_effects() -> str:
    """An overview of the effects, then a section each."""
    rows = [(f"[`{name}`](#{name})", one.regime, ", ".join(one.depends_on)) for name, one in EFFECTS.items()]
    overview = _table(("effect", "regime", "depends on"), rows)
    return EFFECTS_HEAD + overview + "".join(_effect(name, one) for name, one in EFFECTS.items())


def _effect(name: str, effect: Effect) -> str:
    facts = [
        f"- law: `{effect.law}`",
        f"- regime: {effect.regime}; depends on {', '.join(effect.depends_on)}",
        f"- excited by: {effect.excited_by}",
        f"- source: {effect.source}",
    ]
    if not effect.listed:
        facts.append("- a table of numbers that holds any law; the diagnosis fills it and does not name it")
    if effect.not_simulated:
        facts.append(f"- not simulated: {effect.not_simulated}")
    rows = [(f"`{short}`", f"`{row.name}`", *_numbers(row), row.meaning) for short, row in effect.rows.items()]
    if not effect.listed:
        rows = [*rows[:4], ("…", "", "", "", "", ""), rows[-1]]
    table = _table(("number", "parameter", "unit", "default", "range", "meaning"), rows)
    return f"\n## {name} {{#{name}}}\n\n" + "\n".join(facts) + f"\n\n{table}"


def _numbers(row: Parameter) -> tuple[str, str, str]:
    return row.unit, f"{row.default:g}", f"{row.low:g} to {row.high:g}"


def _table(headings: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [headings, ["---"] * len(headings), *rows]
    return "".join(f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in line)} |\n" for line in lines)
