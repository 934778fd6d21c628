"""What was found as a distribution to train on: the text of a draws.toml, from the intervals of what was measured."""

from __future__ import annotations

from collections.abc import Mapping

from puckpilot_env.options.draws_file import FORMAT
from puckpilot_env.options.effects_file import NOT_SWITCHED
from puckpilot_env.parameters import BY_NAME, TABLE, make_records
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.output.effects_toml import GANTRY, found_numbers, told
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.result.context import PLAIN, ReportContext
from sim2real.diagnose.result.result import Estimate

UNLISTED = {row.name for effect in EFFECTS.values() if not effect.listed for row in effect.rows.values()}
SPREAD = "gantry_spread"


def draws_toml(diagnosis: Diagnosis, context: ReportContext = PLAIN) -> str:
    """The numbers of effects.toml as nominal ones, and each that was fitted drawn from its 95 % interval, within what
    the simulator takes.

    What a diagnosis knows without an interval is not drawn. Nor are the gantry's coefficients, of which players may be
    shown their own gantry's shares: as widely as the intervals of C6 and C7 reach, gantries differ from each other
    instead. Laws without a name cannot be drawn; effects.toml holds them.
    """
    near, _ = found_numbers(diagnosis)
    nominal = {name: near[name] for name in (row.name for row in TABLE) if name in near and name not in UNLISTED}
    by = {name: (one, each.regime) for each in told(diagnosis) for name, one in each.baseline.items()}
    by |= {name: (one, found.regime) for found in diagnosis.findings for name, one in found.ranges.items()}
    lines = [f'format = "{FORMAT}"', "", "[parameters]", *(f"{name} = {value!r}" for name, value in nominal.items())]
    where = f" of {' and '.join(context.recordings)}" if context.recordings else ""
    for name in nominal:
        one, regime = by.get(name, (None, ""))
        if one is None or name in GANTRY:
            continue
        low, high = BY_NAME[name].within(one.low), BY_NAME[name].within(one.high)
        if low < high:
            lines += _rows(name, low, high, f"95 % interval, fitted to the {regime}{where}")
    spread = _spread({name: one for name, (one, _) in by.items()}, nominal)
    if spread > 0.0:
        lines += _rows(SPREAD, 0.0, spread, f"widest of the 95 % intervals of C6 and C7, fitted to the gantry{where}")
    return "\n".join([*lines, *_comments(diagnosis)]) + "\n"


def _rows(name: str, low: float, high: float, source: str) -> list[str]:
    words = source.replace("\\", "\\\\").replace('"', '\\"')
    return [
        "",
        f"[draws.{name}]",
        'distribution = "uniform"',
        f"low = {low!r}",
        f"high = {high!r}",
        f'source = "{words}"',
    ]


def _spread(by: Mapping[str, Estimate], nominal: Mapping[str, float]) -> float:
    """By what share C6 and C7 of both axes may be off at most, or as much of it as leaves every gantry overdamped; 0
    where they were not fitted, or it is nothing."""
    if any(name not in by or name not in nominal for name in GANTRY):
        return 0.0
    shares = []
    for i in (2, 3):
        half = sum(0.5 * (by[f"{letter}{i}"].high - by[f"{letter}{i}"].low) for letter in "ab")
        shares += [half / abs(nominal[f"a{i}"] + sign * nominal[f"b{i}"]) for sign in (-1.0, 1.0)]
    spread = BY_NAME[SPREAD].within(max(shares))
    while spread > 1e-4:
        try:
            make_records(1, {**nominal, SPREAD: spread})
            return spread
        except ValueError:
            spread *= 0.5
    return 0.0


def _comments(diagnosis: Diagnosis) -> list[str]:
    """What cannot be drawn, a line each."""
    unlisted = [one for one in diagnosis.findings if one.mechanism == "unlisted" and UNLISTED.intersection(one.values)]
    lines = [
        f"# not drawn: what has no name in the {one.regime} and depends on {' and '.join(one.depends_on)}; "
        "effects.toml has it: give both, --effects effects.toml --draws draws.toml"
        for one in unlisted
    ]
    names = [one.mechanism for one in diagnosis.findings if one.mechanism in EFFECTS]
    return lines + [f"{NOT_SWITCHED} {name}" for name in names if EFFECTS[name].not_simulated]
