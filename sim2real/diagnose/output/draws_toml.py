"""The text of a draws.toml: a distribution of parameters for training, from the intervals of a diagnosis."""

from __future__ import annotations

from collections.abc import Mapping

from puckpilot_env.options.draws_file import FORMAT
from puckpilot_env.options.effects_file import NOT_SWITCHED
from puckpilot_env.parameters import BY_NAME, TABLE, make_records
from puckpilot_env.physics.effects import EFFECTS
from sim2real.diagnose.output.effects_toml import GANTRY, accepted_regimes, found_numbers
from sim2real.diagnose.pipeline import Diagnosis
from sim2real.diagnose.result.context import PLAIN, ReportContext
from sim2real.diagnose.result.result import Estimate, Finding

UNLISTED = {row.name for effect in EFFECTS.values() if not effect.listed for row in effect.rows.values()}
SPREAD = "gantry_spread"


def draws_toml(diagnosis: Diagnosis, context: ReportContext = PLAIN) -> str:
    """Return a draws.toml with the parameters of effects.toml as nominal values.

    Each fitted parameter is drawn from its 95 % interval, clipped to the simulator's range. Parameters without an
    interval are not drawn. Neither are the gantry's coefficients, since players may observe their own gantry's ratio to
    the nominal one: instead the gantry spread is as wide as the intervals of C6 and C7. Unlisted laws cannot be drawn;
    effects.toml has them. Nor are the other parameters of their regime: these intervals are wide because what one of
    them takes the unlisted law gives, so that drawn alone they would be of other tables.
    """
    values, _ = found_numbers(diagnosis)
    nominal = {name: values[name] for name in (row.name for row in TABLE) if name in values and name not in UNLISTED}
    by = {name: (one, each.regime) for each in accepted_regimes(diagnosis) for name, one in each.baseline.items()}
    by |= {name: (one, found.regime) for found in diagnosis.findings for name, one in found.ranges.items()}
    lines = [f'format = "{FORMAT}"', "", "[parameters]", *(f"{name} = {value!r}" for name, value in nominal.items())]
    fixed = {one.regime for one in _unlisted(diagnosis)}
    where = f" of {' and '.join(context.recordings)}" if context.recordings else ""
    for name in nominal:
        one, regime = by.get(name, (None, ""))
        if one is None or name in GANTRY or regime in fixed:
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
    """Return the `playable_spread` of the largest relative error of C6 and C7 of both axes; 0 if not fitted."""
    if any(name not in by or name not in nominal for name in GANTRY):
        return 0.0
    shares = []
    for i in (2, 3):
        half = sum(0.5 * (by[f"{letter}{i}"].high - by[f"{letter}{i}"].low) for letter in "ab")
        shares += [half / abs(nominal[f"a{i}"] + sign * nominal[f"b{i}"]) for sign in (-1.0, 1.0)]
    return playable_spread(max(shares), nominal)


def playable_spread(share: float, nominal: Mapping[str, float]) -> float:
    """Return the `share` by which a gantry's coefficients may differ from those of the `nominal` parameters, reduced
    until every gantry is overdamped; 0 if it is negligible."""
    spread = BY_NAME[SPREAD].within(share)
    while spread > 1e-4:
        try:
            make_records(1, {**nominal, SPREAD: spread})
            return spread
        except ValueError:
            spread *= 0.5
    return 0.0


def _unlisted(diagnosis: Diagnosis) -> list[Finding]:
    """The findings that are laws without a name, as parameters of the simulator."""
    return [one for one in diagnosis.findings if one.mechanism == "unlisted" and UNLISTED.intersection(one.values)]


def _comments(diagnosis: Diagnosis) -> list[str]:
    """Return comments on what cannot be drawn, a line each."""
    lines = [
        f"# not drawn: the unlisted {one.regime} law that depends on {' and '.join(one.depends_on)}, and what else was "
        f"fitted to the {one.regime}; it is in effects.toml: use --effects effects.toml --draws draws.toml"
        for one in _unlisted(diagnosis)
    ]
    names = [one.mechanism for one in diagnosis.findings if one.mechanism in EFFECTS]
    return lines + [f"{NOT_SWITCHED} {name}" for name in names if EFFECTS[name].not_simulated]
