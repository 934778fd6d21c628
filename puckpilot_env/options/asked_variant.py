"""A variant as a caller asks for it: with another period or step limit, with numbers and draws of the caller's own."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace

from puckpilot_env.options.draws_file import Draws, on_tables
from puckpilot_env.options.effects_file import Effects
from puckpilot_env.options.inputs import in_short, one_of, real_number, whole_number
from puckpilot_env.variants import Variant, find_variant

SPARSE = "sparse"
REWARDS = ("shaped", SPARSE)
MOST_STEPS = 1_000_000_000
SHORTEST_PERIOD, LONGEST_PERIOD = 1.0 / 120.0, 1.0  # s


def asked_for(
    variant: Variant | str,
    period: float | None,
    max_cycles: int | None,
    parameters: Mapping[str, float] | None,
    effects: Effects | None,
    draws: Draws | None,
    reward: str | None = None,
) -> tuple[Variant, dict[str, float]]:
    """The variant with this timing and with what is then drawn, and the numbers that are given, by name.

    The arguments are those of `Tables`. Raises ValueError, in one line, for anything that cannot be.
    """
    if not isinstance(variant, Variant):
        variant = find_variant(variant)
    variant = _with_timing(variant, period, max_cycles)
    if one_of(reward, "reward", None, *REWARDS) is not None:
        variant = replace(variant, sparse_reward=reward == SPARSE)
    drawn, values = on_tables(variant, draws, effects, parameters)
    return replace(variant, draws=drawn), values


def _with_timing(variant: Variant, period: float | None, max_cycles: int | None) -> Variant:
    if period is not None:
        seconds = real_number(period)
        if not SHORTEST_PERIOD - 1e-9 <= seconds <= LONGEST_PERIOD:
            words = f"period is {in_short(period)}; expected a number of seconds from 1/120 to {LONGEST_PERIOD:g}"
            raise ValueError(words)
        limit = max(round(variant.step_limit * variant.period / seconds), min(variant.step_limit, 1))
        variant = replace(variant, period=seconds, step_limit=limit)
    if max_cycles is not None:
        variant = replace(variant, step_limit=whole_number(max_cycles, "max_cycles", 1, MOST_STEPS))
    return variant
