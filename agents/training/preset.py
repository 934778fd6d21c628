"""Presets: how to train, as TOML files in `agents/presets/` or of the user's own."""

from __future__ import annotations

import difflib
import math
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Any

from agents.env.rewards import Rewards
from puckpilot_env.files import small_file
from puckpilot_env.options.inputs import in_short, real_number
from puckpilot_env.variants import find_variant

FOLDER = Path(__file__).parents[1] / "presets"
FLIPS = ("rows", "augment", "none")
CRITICS = ("score", "state")  # the critic alone sees the opponent's strength, or the table's true state as well
COUNTS = ("tables", "steps", "round", "cap", "most")
MOST = {"tables": 1 << 16, "hidden": 1 << 12, "num_mini_batches": 1 << 12, "from_steps": 10**12}  # else MOST_OF_ALL
MOST_OF_ALL = 10_000
MOST_LAYERS = 8
# Lowest and highest value; every other number must only be finite.
RANGES = {
    "gate": (0.0, 1.0), "gamma": (0.0, 1.0), "lam": (0.0, 1.0), "clip_param": (0.0, math.inf),
    "learning_rate": (0.0, 1.0), "entropy_coef": (0.0, math.inf),
}  # fmt: skip
SCHEDULABLE = ("learning_rate", "gamma", "lam", "clip_param", "entropy_coef")


@dataclass(frozen=True)
class ScheduledChange:
    """New values from `from_steps` steps of the learner on: `ppo`, some of SCHEDULABLE, and `rewards`, some weights."""

    from_steps: int
    ppo: dict[str, float]
    rewards: dict[str, float]


@dataclass(frozen=True)
class ExtraVariant:
    """An entry of [[beside]]: tables of another variant at which the same network learns. Fields are as in `Preset`."""

    variant: str
    tables: int
    anchors: dict[str, int]
    earlier: tuple[int, ...] = ()


@dataclass(frozen=True)
class Preset:
    """A preset's values under the names of its file; the comments in `agents/presets/fast.toml` explain them.

    - `text`: the whole file. `tables`: tables played at once; `steps`: of each table between two updates; `round`:
      updates between two choices of opponents.
    - `flip`: use of the left-right mirror symmetry. "rows": half of the tables are played mirrored; "augment": every
      sample is followed by its mirror image; "none".
    - `hidden`: units of each hidden layer; `distribution`: a name of `runner.DISTRIBUTIONS`; `init_scale`: its initial
      scale, or None for the default; `critic`: one of CRITICS.
    - `ppo`: hyperparameters by rsl-rl's names; `rewards`: weights of the reward.
    - `anchors`: tables for each fixed opponent, by name; `earlier`: tables of each block whose opponent is drawn anew
      in every round.
    - `gate`: share of points against the snapshots played that makes a new snapshot; `cap`: rounds after which one is
      made in any case; `most`: snapshots kept. They are `League`'s snapshot_threshold, max_rounds and max_snapshots.
    - `average`: updates over which the weights of the player and of snapshots are averaged, evenly at first, then with
      those of longer ago counting for less; 0 for the last weights.
    - `critic_rounds`: rounds at the start in which the critic alone learns, for a player that begins with a trained
      actor and no critic; 0 for none.
    - `later`: values that change during training; `beside`: tables of other variants.
    """

    text: str
    tables: int
    steps: int
    round: int
    flip: str
    hidden: tuple[int, ...]
    distribution: str
    critic: str
    ppo: dict[str, Any]
    rewards: Rewards
    anchors: dict[str, int]
    earlier: tuple[int, ...]
    gate: float
    cap: int
    most: int
    later: tuple[ScheduledChange, ...] = ()
    beside: tuple[ExtraVariant, ...] = ()
    init_scale: float | None = None
    average: int = 0
    critic_rounds: int = 0

    def against(self, player: str) -> Preset:
        """This preset for a best response to `player`, who is the only opponent, at every table.

        A player that a short training beats is exploitable, however well it does against scripts. The learner begins
        untrained and knows of the player only how it plays.
        """
        return replace(self, anchors={player: self.tables}, earlier=(), beside=())

    def at(self, steps: int) -> Preset:
        """The preset with all changes that are due after `steps` steps of the learner."""
        due = [change for change in self.later if change.from_steps <= steps]
        ppo, rewards = dict(self.ppo), self.rewards
        for change in sorted(due, key=lambda one: one.from_steps):
            ppo |= change.ppo
            rewards = replace(rewards, **change.rewards)
        return replace(self, ppo=ppo, rewards=rewards)


def preset_names() -> list[str]:
    """Names of the shipped presets, sorted."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def find_preset(name: str) -> Preset:
    """A shipped preset by name, or a file by path. ValueError, in one line, if it cannot be read."""
    path = FOLDER / f"{name}.toml" if name in preset_names() else Path(name)
    try:
        text = small_file.read_text(path)
    except OSError:
        near = difflib.get_close_matches(str(name), preset_names(), n=1)
        hint = (
            f"did you mean '{near[0]}'?" if near else f"known: {', '.join(preset_names())}, or a path to a .toml file"
        )
        raise ValueError(f"no preset '{name}'; {hint}") from None
    except ValueError as error:
        raise ValueError(f"preset {error}") from None
    return read_preset(text, str(name))


def read_preset(text: str, name: str) -> Preset:
    """Parse a TOML `text`; `name` is used in error messages. ValueError, in one line, for a text that is no preset."""
    try:
        raw = small_file.parse_toml(text)
        network, league = raw.pop("network"), raw.pop("league")
        lists = {"hidden": network.pop("hidden"), "earlier": league.pop("earlier")}
        wrong = [f"{what} is {sizes!r}; expected a list" for what, sizes in lists.items() if type(sizes) is not list]
        if wrong:
            raise TypeError(wrong[0])
        later = tuple(_scheduled_change(entry) for entry in raw.pop("later", []))
        beside = tuple(_extra_variant(entry) for entry in raw.pop("beside", []))
        ppo, rewards = raw.pop("ppo"), _known(Rewards, raw.pop("rewards"))
        numbers = {"text": text, "ppo": ppo, "rewards": Rewards(**rewards), "later": later, "beside": beside}
        sizes = {name: tuple(some) for name, some in lists.items()}
        preset = Preset(**_known(Preset, {**raw, "critic": "score", **network, **league, **sizes, **numbers}))
        preset.at(max((change.from_steps for change in later), default=0))  # raises for an unknown reward
    except KeyError as error:
        raise ValueError(f"preset {name}: it has no {error.args[0]}") from None
    except (AttributeError, TypeError, ValueError) as error:  # a text that is no TOML is a ValueError too
        raise ValueError(f"preset {name}: {error}") from None
    if preset.flip not in FLIPS:
        raise ValueError(f"preset {name}: flip is {preset.flip!r}; expected one of {', '.join(FLIPS)}")
    if preset.critic not in CRITICS:
        raise ValueError(f"preset {name}: critic is {preset.critic!r}; expected one of {', '.join(CRITICS)}")
    if preset.flip == "augment" and preset.critic == "state":
        raise ValueError(f"preset {name}: flip 'augment' does not mirror what a critic of the 'state' sees; use 'rows'")
    if "gamma" not in preset.ppo:
        raise ValueError(f"preset {name}: [ppo] has no gamma, by which shaping and returns are discounted")
    _check_counts(preset, name)
    _check_numbers(preset, name)
    return preset


def _known(made: type[Any], entries: Mapping[str, Any]) -> dict[str, Any]:
    """The entries, if they are fields of the dataclass `made`.

    KeyError for a missing one, TypeError for an unknown one.
    """
    known = {field.name: field for field in fields(made)}
    unknown = [name for name in entries if name not in known]
    if unknown:
        own = [name for name in known if name not in ("text", "later", "beside")]
        raise TypeError(f"'{unknown[0]}' is unknown; known: {', '.join(own)}")
    for name, field in known.items():
        if field.default is MISSING and name not in entries:
            raise KeyError(name)
    return dict(entries)


def _check_numbers(preset: Preset, name: str) -> None:
    """ValueError for a number out of its range, in the preset itself or after a scheduled change."""
    for each in (preset, *(preset.at(change.from_steps) for change in preset.later)):
        named = {**{key: each.ppo[key] for key in SCHEDULABLE if key in each.ppo}, **vars(each.rewards)}
        for what, number in {**named, "gate": each.gate}.items():
            low, high = RANGES.get(what, (-math.inf, math.inf))
            if not (low <= real_number(number) <= high and math.isfinite(real_number(number))):
                expected = f"a number from {low:g} to {high:g}" if what in RANGES else "a finite number"
                raise ValueError(f"preset {name}: {what} is {in_short(number)}; expected {expected}")


def _scheduled_change(entry: dict[str, Any]) -> ScheduledChange:
    ppo, rewards = dict(entry.pop("ppo", {})), dict(entry.pop("rewards", {}))
    unknown = [name for name in ppo if name not in SCHEDULABLE]
    if unknown:
        raise TypeError(f"[[later]] changes {', '.join(unknown)}; what may change is {', '.join(SCHEDULABLE)}")
    numbers = [{name: float(number) for name, number in some.items()} for some in (ppo, rewards)]
    return ScheduledChange(ppo=numbers[0], rewards=numbers[1], **entry)


def _extra_variant(entry: dict[str, Any]) -> ExtraVariant:
    return ExtraVariant(find_variant(entry.pop("variant")).id, earlier=tuple(entry.pop("earlier", [])), **entry)


def _check_counts(preset: Preset, name: str) -> None:
    """ValueError for a count that is no whole number from 1 on, or that is too large."""
    named = [(count, getattr(preset, count)) for count in COUNTS]
    named += [(part, size) for part in ("hidden", "earlier") for size in getattr(preset, part)]
    named += [(part, preset.ppo[part]) for part in ("num_learning_epochs", "num_mini_batches") if part in preset.ppo]
    named += list(preset.anchors.items())
    named += [(part, getattr(preset, part)) for part in ("average", "critic_rounds") if getattr(preset, part) != 0]
    for one in preset.beside:
        named += [(f"[[beside]] {one.variant}", size) for size in (one.tables, *one.anchors.values(), *one.earlier)]
    named += [("[[later]] from_steps", change.from_steps) for change in preset.later]
    for what, count in named:
        most = MOST.get(what.split()[-1], MOST_OF_ALL)
        if type(count) is not int or not 1 <= count <= most:
            raise ValueError(f"preset {name}: {what} is {in_short(count)}; expected a whole number from 1 to {most:,}")
    if not 1 <= len(preset.hidden) <= MOST_LAYERS:
        raise ValueError(f"preset {name}: hidden has {len(preset.hidden)} layers; expected 1 to {MOST_LAYERS}")
    samples, parts = preset.tables * preset.steps, preset.ppo.get("num_mini_batches", 1)
    if parts > samples:
        raise ValueError(f"preset {name}: num_mini_batches is {parts}; expected at most tables x steps = {samples:,}")
