"""The text of an effects.toml: the findings as parameters of the simulator."""

from __future__ import annotations

from collections.abc import Mapping

from puckpilot_env.options.effects_file import FORMAT as EFFECTS_FORMAT
from puckpilot_env.options.effects_file import NOT_SWITCHED
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, TABLE, make_records
from puckpilot_env.physics.effects import EFFECTS, MODULES
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.result.result import Finding, RegimeResult

# Unlisted effects, which are tables of coefficients, in words
TABLES = {
    "unlisted_force": "an unlisted force",
    "unlisted_bounce": "an unlisted change of the speed ratio at walls (share 1: normal, 2: along the wall, 3: both)",
    "unlisted_drive": "unlisted extra volts on the gantry's axes (axes 1: x, 2: y, 3: both)",
    "unlisted_blow": "an unlisted change of the speed ratio at a mallet (share 1: normal, 2: tangential, 3: both)",
}
GANTRY = ("a1", "a2", "a3", "b1", "b2", "b3")
NO_HISTORY = "the simulator does not store the time of the puck's last contact"
NO_HISTORY_OF_VOLTS = "the simulator does not store averages of the motors' volts and speeds"


def effects_toml(diagnosis: Diagnosis) -> str:
    """Return an effects.toml with the table's stated sizes, the refitted baseline and all findings.

    Each parameter is clipped to its range, and combinations that the simulator rejects are left out. Comments name the
    findings that the simulator cannot represent, such as clock drift, since its players have one clock, and the
    undetermined regimes. Refitted parameters of those are included only if they predict launches better than the
    defaults.
    """
    values, left_out = found_numbers(diagnosis)
    plain = [row.name for row in TABLE if row.name in values and row not in EFFECT_ROWS]
    lines = [f'format = "{EFFECTS_FORMAT}"', "", "[parameters]", *(f"{name} = {values[name]!r}" for name in plain)]
    for name, effect in EFFECTS.items():
        taken = {} if effect.not_simulated else effect.rows
        numbers = [f"{key} = {values[row.name]!r}" for key, row in taken.items() if row.name in values]
        lines += ["", *_comments(name, values), f"[effects.{name}]", *numbers] if numbers else []
    lines += [_formula(one) for one in diagnosis.findings if _is_table(one)]
    lines += [
        f"{NOT_SWITCHED} {_size(name, value)}" for name, value in diagnosis.sizes.items() if not _fits(name, value)
    ]
    lines += [f"{NOT_SWITCHED} {_name(one)}" for one in diagnosis.findings if not _simulated(one)]
    lines += [f"{NOT_SWITCHED} {left_out}"] if left_out else []
    lines += [_undetermined(each) for each in diagnosis.inconclusive_regimes]
    if diagnosis.verdict == "undetermined":
        lines.append("# the diagnosis is undetermined: apart from these lines the simulator is unchanged")
    return "\n".join(lines) + "\n"


def found_numbers(diagnosis: Diagnosis) -> tuple[Mapping[str, float], str]:
    """Return the simulator's parameters by name for the diagnosed table, and in words which were left out.

    Parameters are clipped to their ranges; those of a combination that the simulator rejects are left out.
    """
    values = {name: value for name, value in diagnosis.sizes.items() if _fits(name, value)}
    values |= {name: one.value for each in accepted_regimes(diagnosis) for name, one in each.baseline.items()}
    for one in diagnosis.findings:
        values |= one.values
    return _together({name: BY_NAME[name].within(value) for name, value in values.items()}, diagnosis.sizes)


def accepted_regimes(diagnosis: Diagnosis) -> list[RegimeResult]:
    """Return the results whose refitted parameters are written to the files."""
    return [each for each in diagnosis.regime_results if each.better or not each.undetermined]


def _fits(name: str, value: float) -> bool:
    return BY_NAME[name].within(value) == value


def _together(values: Mapping[str, float], sizes: Mapping[str, float]) -> tuple[Mapping[str, float], str]:
    """Return those of `values` that the simulator accepts together, and in words which were left out.

    Coefficients that make no valid law are left out first, then the sizes and, if that is not enough, the gantry's
    parameters.
    """
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


def _undetermined(each: RegimeResult) -> str:
    """Return the comment on an undetermined regime."""
    numbers = ", ".join(f"{name} = {one.value:.5g}" for name, one in each.baseline.items())
    if each.better and numbers:
        return f"# the {each.regime} parameters above only improve on the previous ones ({each.undetermined})"
    fitted = f"; the fitted values are no better: {numbers}" if numbers else ""
    return f"# the {each.regime} is unchanged ({each.undetermined}){fitted}"


def _comments(name: str, values: Mapping[str, float]) -> list[str]:
    """Return comments on the meaning of an effect's parameters."""
    if name not in TABLES:
        return [f"# {EFFECTS[name].law}"]
    kind = f"{values[EFFECTS[name].rows['kind'].name]:.0f}"
    table = [[cell.strip() for cell in line.split("|")] for line in (MODULES[name].__doc__ or "").splitlines()]
    meaning = next(row[2:4] for row in table if len(row) > 3 and kind in row[1].split(", "))
    return [f"# {TABLES[name]}: {meaning[0]}; coefficients c00, c01, ...: {meaning[1]}"]


def _formula(one: Finding) -> str:
    """Return the comment on the formula of a table of coefficients; that of the gantry is made of the formula."""
    return f"# as a formula{'' if one.regime == 'gantry' else ', fitted separately'}: {one.formula}"


def _is_table(one: Finding) -> bool:
    """Return whether the simulator represents a finding as a table of coefficients."""
    return one.mechanism == "unlisted" and _simulated(one)


def _simulated(one: Finding) -> bool:
    return bool(one.values) and not _why_not(one)


def _why_not(one: Finding) -> str:
    if one.mechanism == "unlisted" and "history" in one.depends_on:
        return NO_HISTORY_OF_VOLTS if one.regime == "gantry" else NO_HISTORY
    return EFFECTS[one.mechanism].not_simulated if one.mechanism in EFFECTS else ""


def _size(name: str, value: float) -> str:
    row = BY_NAME[name]
    return f"{name} {value:g} {row.unit}, outside its range {row.low:g} to {row.high:g} {row.unit}"


def _name(one: Finding) -> str:
    """Return a finding in words and, if known, why the simulator cannot represent it."""
    depends = f"{one.mechanism} of the {one.regime}, which depends on {' and '.join(one.depends_on) or 'nothing'}"
    return f"{depends}: {_why_not(one)}" if _why_not(one) else depends
