"""Tables at the ends of what the simulator accepts: sizes, numbers of the baseline, and one, two or many effects.

A batch shares what its arrays depend on (sizes, period, camera); all else each table draws by itself.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np

from puckpilot_env import variants
from puckpilot_env.effect import Parameter
from puckpilot_env.options.asked_variant import LONGEST_PERIOD, SHORTEST_PERIOD
from puckpilot_env.parameters import BY_NAME, EFFECT_ROWS, TABLE, check_together, make_records
from puckpilot_env.physics.effects import EFFECTS
from puckpilot_env.tables import Tables

SHARED = ("length", "width", "goal_width", "puck_radius", "mallet_radius", "frame_rate", "camera_latency")
GANTRY = ("pulley_radius", "max_voltage", "a1", "a2", "a3", "b1", "b2", "b3", "gantry_spread")
OWN = tuple(row.name for row in TABLE if row not in EFFECT_ROWS and row.name not in (*SHARED, *GANTRY))
SIMULATED = tuple(name for name, effect in EFFECTS.items() if not effect.not_simulated)
WHOLE = ("kind", "share", "axes")  # short names of rows that choose one of some laws
TRIES = 50  # of numbers that make a table together, before the defaults are taken


def draw_value(row: Parameter, rng: np.random.Generator) -> float:
    """A number in a row's range: an end, anything between, or a small way off the default."""
    way = rng.random()
    if way < 0.25:
        return row.low
    if way < 0.5:
        return row.high
    if way < 0.85:
        return float(rng.uniform(row.low, row.high))
    end = row.high if rng.random() < 0.5 else row.low
    return row.within(row.default + (end - row.default) * 10.0 ** rng.uniform(-9.0, 0.0))


def draw_effects(rng: np.random.Generator) -> dict[str, float]:
    """Numbers, by the simulator's names, that switch on none, one, two or many of the effects that a table can have."""
    way = rng.random()
    if way < 0.1:
        chosen: Sequence[str] = ()
    elif way < 0.7:
        chosen = rng.choice(SIMULATED, 1 if way < 0.45 else 2, replace=False).tolist()
    else:
        chosen = [name for name in SIMULATED if rng.random() < 0.4]
    values: dict[str, float] = {}
    for name in chosen:
        values |= _draw_rows(name, rng) if EFFECTS[name].listed else _draw_law(name, rng)
    return values


def _draw_rows(name: str, rng: np.random.Generator) -> dict[str, float]:
    rows = EFFECTS[name].rows.values()
    return {row.name: draw_value(row, rng) for row in rows if len(rows) == 1 or rng.random() < 0.8}


def _draw_law(name: str, rng: np.random.Generator) -> dict[str, float]:
    """Numbers of an effect that has no name; none where those drawn made no law."""
    rows = EFFECTS[name].rows
    coefficients = [short for short in rows if short[1:].isdigit()]
    for _ in range(TRIES):
        scale, knots = 10.0 ** rng.uniform(-6.0, 0.0), int(rng.choice((0, 0, 2, 4, 5, 10)))
        values = {}
        for short, row in rows.items():
            if short in WHOLE:
                values[short] = float(rng.integers(int(max(row.low, 1.0)), int(row.high) + 1))
            else:
                values[short] = scale * draw_value(row, rng)
        first = coefficients[:knots]
        values |= dict(zip(first, sorted(values[short] / scale**0.5 for short in first), strict=True))
        values = {short: row.within(values[short]) for short, row in rows.items()}
        if not EFFECTS[name].misfit(values):
            return {row.name: values[short] for short, row in rows.items()}
    return {}


def _fits(record: np.void, values: Mapping[str, float]) -> bool:
    """Whether `values` in place of those of a record make a table."""
    record = record.copy()
    for name, value in values.items():
        record[name] = value
    try:
        check_together(record)
    except ValueError:
        return False
    return True


def _draw_fitting(
    names: Sequence[str], share: float, rng: np.random.Generator, record: np.void, others: Mapping[str, float]
) -> dict[str, float]:
    """Numbers for a `share` of these rows that make a table with the `others`; none where that was not found."""
    for _ in range(TRIES):
        values = {name: draw_value(BY_NAME[name], rng) for name in names if rng.random() < share}
        if _fits(record, {**others, **values}):
            return values
    return {}


def _widest(variant: variants.Variant) -> np.void:
    """A variant's numbers where its draws are at their upper ends."""
    record = make_records(1, variant.parameters)[0]
    for draw in variant.draws:
        record[draw.parameter] = draw.high
    return record


def draw_tables(name: str, count: int, seed: int) -> tuple[Tables, np.random.Generator]:
    """`count` tables of a variant's id, all different, after their reset; and the generator for what follows."""
    rng = np.random.default_rng(seed)
    variant = variants.find_variant(name)
    widest = _widest(variant)
    shared = _draw_fitting(SHARED, 0.5, rng, widest, {}) if rng.random() < 0.5 else {}
    way = rng.random()
    period = None if way < 0.8 else SHORTEST_PERIOD if way < 0.9 else LONGEST_PERIOD
    tables = Tables(variant, count, seed=seed, period=period, parameters=shared)
    drawn = {draw.parameter for draw in variant.draws}
    for i in range(count):
        values = draw_effects(rng)
        if rng.random() < 0.5:
            values |= _draw_fitting([name for name in OWN if name not in drawn], 0.3, rng, widest, shared)
        if rng.random() < 0.2:
            values |= _draw_fitting([name for name in GANTRY if name not in drawn], 0.5, rng, widest, shared)
        if values.get("command_delay", 0.0) >= tables.variant.period:
            del values["command_delay"]
        for key, value in values.items():
            tables.params[key][i] = value
        check_together(tables.params[i])
    tables.reset(seed)
    return tables, rng


def described(tables: Tables, i: int) -> str:
    """The numbers of table `i` that are not the defaults, in one line."""
    found = {row.name: float(tables.params[row.name][i]) for row in TABLE}
    other = [f"{name} {value:.6g}" for name, value in found.items() if value != BY_NAME[name].default]
    return f"period {tables.variant.period:g} s" + "".join(f", {each}" for each in other)
