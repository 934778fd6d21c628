"""How to train, as a file in `agents/presets/` or of the user's own."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import MISSING, dataclass, fields, replace
from pathlib import Path
from typing import Any

from agents.rewards import Rewards
from puckpilot_env import small_file
from puckpilot_env.inputs import in_short, real_number
from puckpilot_env.variants import find_variant

FOLDER = Path(__file__).parent / "presets"
FLIPS = ("rows", "augment", "none")
CRITICS = ("score", "state")  # what only the critic sees: how strong the opponent is, or the table's true state as well
COUNTS = ("tables", "steps", "round", "cap", "most")
MOST = {"tables": 1 << 16, "hidden": 1 << 12, "num_mini_batches": 1 << 12, "from_steps": 10**12}  # else MOST_OF_ALL
MOST_OF_ALL = 10_000
MOST_LAYERS = 8
# The least and the greatest that a number may be; every other one must be finite.
RANGES = {
    "gate": (0.0, 1.0), "gamma": (0.0, 1.0), "lam": (0.0, 1.0), "clip_param": (0.0, math.inf),
    "learning_rate": (0.0, 1.0), "entropy_coef": (0.0, math.inf),
}  # fmt: skip
CHANGEABLE = ("learning_rate", "gamma", "lam", "clip_param", "entropy_coef")


@dataclass(frozen=True)
class Change:
    """What holds from `from_steps` steps of the learner on: some numbers of CHANGEABLE, and of the rewards."""

    from_steps: int
    ppo: dict[str, float]
    rewards: dict[str, float]


@dataclass(frozen=True)
class Beside:
    """Tables of another variant beside the run's own, at which the same network learns; see `Preset`."""

    variant: str
    tables: int
    anchors: dict[str, int]
    earlier: tuple[int, ...] = ()


@dataclass(frozen=True)
class Preset:
    """A preset's numbers, by the names of its file; see the comments in `agents/presets/fast.toml`."""

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
    later: tuple[Change, ...] = ()
    beside: tuple[Beside, ...] = ()
    init_scale: float | None = None

    def at(self, steps: int) -> Preset:
        """What holds after so many steps."""
        due = [change for change in self.later if change.from_steps <= steps]
        ppo, rewards = dict(self.ppo), self.rewards
        for change in sorted(due, key=lambda one: one.from_steps):
            ppo |= change.ppo
            rewards = replace(rewards, **change.rewards)
        return replace(self, ppo=ppo, rewards=rewards)


def preset_names() -> list[str]:
    """Names of the shipped presets."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def find_preset(name: str) -> Preset:
    """A shipped preset by name, or one of the user's by path. ValueError, in one line, for one that cannot be read."""
    path = FOLDER / f"{name}.toml" if name in preset_names() else Path(name)
    try:
        text = small_file.read_text(path)
    except OSError:
        raise ValueError(f"no preset '{name}'; known: {', '.join(preset_names())}, or a path to a .toml file") from None
    except ValueError as error:
        raise ValueError(f"preset {error}") from None
    return read_preset(text, str(name))


def read_preset(text: str, name: str) -> Preset:
    """The preset of a TOML text. ValueError, in one line, for a text that is not one."""
    try:
        raw = small_file.parse_toml(text)
        network, league = raw.pop("network"), raw.pop("league")
        lists = {"hidden": network.pop("hidden"), "earlier": league.pop("earlier")}
        wrong = [f"{what} is {sizes!r}; expected a list" for what, sizes in lists.items() if type(sizes) is not list]
        if wrong:
            raise TypeError(wrong[0])
        later = tuple(_change(entry) for entry in raw.pop("later", []))
        beside = tuple(_beside(entry) for entry in raw.pop("beside", []))
        ppo, rewards = raw.pop("ppo"), _known(Rewards, raw.pop("rewards"))
        numbers = {"text": text, "ppo": ppo, "rewards": Rewards(**rewards), "later": later, "beside": beside}
        sizes = {name: tuple(some) for name, some in lists.items()}
        preset = Preset(**_known(Preset, {**raw, "critic": "score", **network, **league, **sizes, **numbers}))
        preset.at(max((change.from_steps for change in later), default=0))  # its rewards are known ones
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
    """The entries, if they are what a dataclass is made of. KeyError for one that is missing, TypeError for others."""
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
    for each in (preset, *(preset.at(change.from_steps) for change in preset.later)):
        named = {**{key: each.ppo[key] for key in CHANGEABLE if key in each.ppo}, **vars(each.rewards)}
        for what, number in {**named, "gate": each.gate}.items():
            low, high = RANGES.get(what, (-math.inf, math.inf))
            if not (low <= real_number(number) <= high and math.isfinite(real_number(number))):
                expected = f"a number from {low:g} to {high:g}" if what in RANGES else "a finite number"
                raise ValueError(f"preset {name}: {what} is {in_short(number)}; expected {expected}")


def _change(entry: dict[str, Any]) -> Change:
    ppo, rewards = dict(entry.pop("ppo", {})), dict(entry.pop("rewards", {}))
    unknown = [name for name in ppo if name not in CHANGEABLE]
    if unknown:
        raise TypeError(f"[[later]] changes {', '.join(unknown)}; what may change is {', '.join(CHANGEABLE)}")
    numbers = [{name: float(number) for name, number in some.items()} for some in (ppo, rewards)]
    return Change(ppo=numbers[0], rewards=numbers[1], **entry)


def _beside(entry: dict[str, Any]) -> Beside:
    return Beside(find_variant(entry.pop("variant")).id, earlier=tuple(entry.pop("earlier", [])), **entry)


def _check_counts(preset: Preset, name: str) -> None:
    named = [(count, getattr(preset, count)) for count in COUNTS]
    named += [(part, size) for part in ("hidden", "earlier") for size in getattr(preset, part)]
    named += [(part, preset.ppo[part]) for part in ("num_learning_epochs", "num_mini_batches") if part in preset.ppo]
    named += list(preset.anchors.items())
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
