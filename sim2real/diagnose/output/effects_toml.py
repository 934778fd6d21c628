"""What was found, as the simulator takes it: the text of an effects.toml."""

from __future__ import annotations

from collections.abc import Mapping

from puckpilot_env.options.effects_file import FORMAT as EFFECTS_FORMAT
from puckpilot_env.options.effects_file import NOT_SWITCHED
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, TABLE, make_records
from puckpilot_env.physics.effects import EFFECTS, MODULES
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.result.result import Finding, RegimeResult

# An effect that is a table of numbers, in words
TABLES = {
    "unlisted_force": "a force",
    "unlisted_bounce": "a change of what bounces keep of their speed (share 1: normal, 2: along the wall, 3: both)",
    "unlisted_blow": "a change of what pucks keep of their speed past a mallet (share 1: normal, 2: along, 3: both)",
}
GANTRY = ("a1", "a2", "a3", "b1", "b2", "b3")
REMEMBERS = "a table does not know when its puck last touched something"


def effects_toml(diagnosis: Diagnosis) -> str:
    """The table's stated sizes, the refitted baseline and all that was found, as the simulator takes it: each fitted
    number within its range, and none that together would make no table.

    What it has no place for is named in a comment, such as a clock that drifts, since its players have one clock; and
    so are regimes that cannot tell, of which numbers are taken that foretell untouched launches better than its own.
    """
    near, apart = found_numbers(diagnosis)
    plain = [row.name for row in TABLE if row.name in near and row not in EFFECT_ROWS]
    lines = [f'format = "{EFFECTS_FORMAT}"', "", "[parameters]", *(f"{name} = {near[name]!r}" for name in plain)]
    for name, effect in EFFECTS.items():
        taken = {} if effect.not_simulated else effect.rows
        numbers = [f"{key} = {near[row.name]!r}" for key, row in taken.items() if row.name in near]
        lines += ["", *_comments(name, near), f"[effects.{name}]", *numbers] if numbers else []
    lines += [f"# in a formula, fitted for itself: {one.formula}" for one in diagnosis.findings if _is_table(one)]
    lines += [
        f"{NOT_SWITCHED} {_size(name, value)}" for name, value in diagnosis.sizes.items() if not _fits(name, value)
    ]
    lines += [f"{NOT_SWITCHED} {_name(one)}" for one in diagnosis.findings if not _simulated(one)]
    lines += [f"{NOT_SWITCHED} {apart}"] if apart else []
    lines += [_not_told(each) for each in diagnosis.inconclusive_regimes]
    if diagnosis.verdict == "undetermined":
        lines.append(
            "# the diagnosis could not tell what is missing: beyond these lines this is the simulator as it was"
        )
    return "\n".join(lines) + "\n"


def found_numbers(diagnosis: Diagnosis) -> tuple[Mapping[str, float], str]:
    """The simulator's parameters by name of the table that was found, each within its range, and in words which were
    left out because together they would make no table."""
    values = {name: value for name, value in diagnosis.sizes.items() if _fits(name, value)}
    values |= {name: one.value for each in told(diagnosis) for name, one in each.baseline.items()}
    for one in diagnosis.findings:
        values |= one.values
    return _together({name: BY_NAME[name].within(value) for name, value in values.items()}, diagnosis.sizes)


def told(diagnosis: Diagnosis) -> list[RegimeResult]:
    """The accounts whose refitted numbers are taken."""
    return [each for each in diagnosis.regime_results if each.better or not each.undetermined]


def _fits(name: str, value: float) -> bool:
    return BY_NAME[name].within(value) == value


def _together(values: Mapping[str, float], sizes: Mapping[str, float]) -> tuple[Mapping[str, float], str]:
    """Those of `values` that make a table together, and in words which were left out for that: tables of numbers that
    make no law, then the sizes or, if that is not enough, the gantry's numbers."""
    out, why = dict(values), []
    for name, effect in EFFECTS.items():
        rows = {short: row for short, row in effect.rows.items() if row.name in out}
        reason = effect.misfit({short: out.get(row.name, row.default) for short, row in effect.rows.items()})
        if rows and reason:
            out = {name: value for name, value in out.items() if name not in effect.row_names}
            why.append(f"{name}: {reason}")
    for some in (sizes, GANTRY):
        try:
            make_records(1, out)
            break
        except ValueError as error:
            gone = [name for name in out if name in some]
            out = {name: value for name, value in out.items() if name not in some}
            why += [f"{', '.join(f'{name} {values[name]:.5g}' for name in gone)}: {error}"] if gone else []
    return out, "; ".join(why)


def _not_told(each: RegimeResult) -> str:
    """What becomes of a regime that cannot tell."""
    numbers = ", ".join(f"{name} = {one.value:.5g}" for name, one in each.baseline.items())
    if each.better and numbers:
        return (
            f"# the {each.regime} is not explained by its numbers above ({each.undetermined}), only better than before"
        )
    fitted = f"; fitted all the same, no better: {numbers}" if numbers else ""
    return f"# the {each.regime} is left as it was ({each.undetermined}){fitted}"


def _comments(name: str, values: Mapping[str, float]) -> list[str]:
    """What the numbers of an effect mean."""
    if EFFECTS[name].listed:
        return [f"# {EFFECTS[name].law}"]
    kind = f"{values[EFFECTS[name].rows['kind'].name]:.0f}"
    table = [[cell.strip() for cell in line.split("|")] for line in (MODULES[name].__doc__ or "").splitlines()]
    meaning = next(row[2:4] for row in table if len(row) > 3 and kind in row[1].split(", "))
    return [f"# {TABLES[name]} that has no name: {meaning[0]}; its numbers c00, c01, ...: {meaning[1]}"]


def _is_table(one: Finding) -> bool:
    """Whether players meet a finding as a table of numbers, with which its proof was made."""
    return one.mechanism == "unlisted" and _simulated(one)


def _simulated(one: Finding) -> bool:
    return bool(one.values) and not _why_not(one)


def _why_not(one: Finding) -> str:
    if one.mechanism == "unlisted" and one.regime in ("glide", "wall") and "history" in one.depends_on:
        return REMEMBERS
    return EFFECTS[one.mechanism].not_simulated if one.mechanism in EFFECTS else ""


def _size(name: str, value: float) -> str:
    row = BY_NAME[name]
    return f"{name} {value:g} {row.unit}, which is beyond its {row.low:g} to {row.high:g} {row.unit}"


def _name(one: Finding) -> str:
    """A finding in words, and why no table can be given it, where that is known."""
    depends = f"{one.mechanism} of the {one.regime}, which depends on {' and '.join(one.depends_on) or 'nothing'}"
    return f"{depends}: {_why_not(one)}" if _why_not(one) else depends
