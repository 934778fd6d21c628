"""That a table turned round, its players swapped, plays the same game: one policy may then play both seats.

A batch plays; a copy of it is turned and plays the swapped actions. What each player sees, earns and how it ends has to
agree. Turning computes x -> length - x, so places differ by rounding (1e-16 m) from the start, and every bounce off a
round thing multiplies that: by about a dozen in a step of pushing the puck along. The copy is therefore made anew every
few steps: too soon for rounding to grow to `TOLERANCE`, and often enough in all the game's situations, which are
counted. Random numbers need no tolerance: each player's stream goes with it, and what the table's own draws is turned.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from puckpilot_env import variants
from puckpilot_env.checks.result import Check, Fault, Subject
from puckpilot_env.tables import Tables

TABLES = 32
MOST_STEPS = 300
COPY_EVERY = 5  # steps
# Relative to 1 or to the number. A puck pushed along or pinched touches its mallet again and again; where two things
# nearly happen at once rounding decides which is first: up to a micrometre then, sixty times that in a measured speed.
TOLERANCE = 1e-3
ROUNDING = 1e-12  # m, m/s; of turning twice

# Shaken and hurried, so that endings, fouls, impulses and noise come in a few seconds of any variant.
_SHAKEN = {
    "impulse_rate": 2.0,
    "action_noise": 0.05,
    "gantry_spread": 0.1,
    "camera_noise": 0.002,
    "frame_jitter": 0.0003,
    "dropped_frames": 0.1,
}


@dataclass
class _Seen:
    goals: int = 0
    ends: int = 0
    fouls: int = 0

    def count(self, before: np.ndarray, tables: Tables) -> None:
        """Note what the last step brought; `before`: the states before it."""
        ended = tables.terminated | tables.truncated
        goals = (tables.states["score"].sum(1) > before["score"].sum(1)) & ~ended
        self.ends += int(ended.sum())
        self.goals += int(goals.sum())
        self.fouls += int((tables.states["fouls"] - before["fouls"])[~ended].sum())


def _versions(variant: variants.Variant) -> tuple[variants.Variant, ...]:
    drawn = {draw.parameter for draw in variant.draws}
    shaken = {name: value for name, value in _SHAKEN.items() if name not in drawn}
    hurried = replace(
        variant, parameters={**variant.parameters, **shaken}, points=2, match_time=9.0, possession_time=1.5
    )
    return variant, hurried


def _swapped(array: np.ndarray) -> np.ndarray:
    return array[:, ::-1]


def _copy_turned(tables: Tables, turned: Tables) -> None:
    turned.restore(tables.snapshot())
    turned.turn()


def _disagreement(tables: Tables, turned: Tables) -> str | None:
    pairs = {
        "observations": (tables.observations, _swapped(turned.observations)),
        "final observations": (tables.final_observations, _swapped(turned.final_observations)),
        "rewards": (tables.rewards, _swapped(turned.rewards)),
    }
    ended = tables.terminated | tables.truncated
    if not np.array_equal(ended, turned.terminated | turned.truncated):
        return "an episode ended on one of the two alone"
    for name, (a, b) in pairs.items():
        apart = np.abs(a - b) / np.maximum(1.0, np.abs(a))
        if name == "final observations":
            apart = apart * ended[:, None, None]
        if not apart.max() <= TOLERANCE:
            at = np.unravel_index(int(np.nanargmax(apart)), apart.shape)
            column = f" ({tables.observation_columns[at[2]].name})" if len(at) == 3 else ""
            return f"{name}{column} of player_{at[1]} are {a[at]:g}, and {b[at]:g} on the turned table"
    return None


def _play_both(variant: variants.Variant, steps: int, seed: int, seen: _Seen) -> None:
    tables, turned = Tables(variant, TABLES, seed=seed), Tables(variant, TABLES)
    rng = np.random.default_rng(seed)
    low, high = tables.action_bounds
    for step in range(steps):
        if step % COPY_EVERY == 0:
            _copy_turned(tables, turned)
        actions = rng.uniform(low, high, (TABLES, 2, 4)).astype(np.float32)
        before = tables.states.copy()
        tables.step(actions)
        turned.step(_swapped(actions))
        seen.count(before, tables)
        found = _disagreement(tables, turned)
        if found is not None:
            raise Fault(f"step {step + 1}, {step % COPY_EVERY + 1} after turning: {found}")


def _own_tables(subject: Subject) -> Any:
    """The batch behind an environment of this project, or None."""
    tables = getattr(subject.make().unwrapped, "tables", None)
    return tables if isinstance(tables, Tables) else None


def _symmetric(subject: Subject) -> str:
    own = _own_tables(subject)
    if own is None:
        return "does not apply: only known for this project's own tables"
    seen = _Seen()
    steps = min(MOST_STEPS, subject.steps)
    for variant in _versions(own.variant):
        _play_both(variant, steps, subject.seed, seen)
    return (
        f"{2 * steps * TABLES:,} steps of turned tables agree, through {seen.goals} goals, {seen.fouls} fouls "
        f"and {seen.ends} endings"
    )


def _changed(before: np.ndarray, after: np.ndarray, where: str = "") -> str | None:
    """The first field of two arrays of records that is not the same, numbers with a point up to rounding."""
    if before.dtype.names:
        found = (_changed(before[name], after[name], f"{where}{name} ") for name in before.dtype.names)
        return next((each for each in found if each is not None), None)
    same = before == after
    if before.dtype.kind == "f":
        with np.errstate(invalid="ignore"):  # of two infinities, which are the same
            same |= np.abs(before - after) <= ROUNDING
    return None if np.all(same) else f"{where}is not what it was after turning twice"


def _inverse(subject: Subject) -> str:
    own = _own_tables(subject)
    if own is None:
        return "does not apply: only known for this project's own tables"
    tables = Tables(own.variant, TABLES, seed=subject.seed)
    rng = np.random.default_rng(subject.seed)
    low, high = tables.action_bounds
    for step in range(min(50, subject.steps)):
        before = tables.snapshot()
        tables.turn()
        tables.turn()
        after = tables.snapshot()
        found = _changed(before.states, after.states) or _changed(before.frames, after.frames, "frames ")
        if not np.array_equal(before.observations, after.observations):
            found = "observations are not what they were after turning twice"
        if found is not None:
            raise Fault(f"step {step}: {found}")
        tables.restore(before)
        tables.step(rng.uniform(low, high, (TABLES, 2, 4)))
    return "turning twice gives the same table back, places up to rounding and all else exactly"


CHECKS = (
    Check(
        "turned table, same game",
        "Neither seat has an advantage, and one policy can play both.",
        "Let everything with an end or a side go through game.mirror, and turn every field of the state in turn_table.",
        _symmetric,
    ),
    Check(
        "turning is its own inverse",
        "A table can be turned there and back, as self-play with changing seats does.",
        "Swap or reflect each field in turn_table; do not set it.",
        _inverse,
    ),
)
