"""A training run: rounds of a league, each some updates against the same opponents, then a checkpoint.

A round seats its opponents anew, so that a checkpoint between rounds is all that there is to know: a run that was
killed goes on from its last round and, on one thread, takes the very same path.
"""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from agents import ranks, saving
from agents.exploit import against
from agents.hall import Hall, readings
from agents.league import League, Member
from agents.learner_env import LearnerEnv
from agents.policy import Policy, PolicyPlayer
from agents.preset import CHANGEABLE, Preset, read_preset
from agents.run_folder import RunFolder
from agents.runner import Iteration, SelfPlayRunner
from agents.seating import Seating
from baselines import make_player
from baselines.player import Player, Seat
from puckpilot_env.effects_file import as_content
from puckpilot_env.game.start import MATCH
from puckpilot_env.tables import Tables

RANKS_APART = 2**32  # between the seeds of processes that train together
PARTS_APART = 2**48  # between the seeds of the parts of a hall
Row = dict[str, Any]


@dataclass(frozen=True)
class Settings:
    """What is trained. `effects`: parameters of an effects file, or None; `draws`: what a file of draws holds, or None;
    `against`: the one player that is met, else a league is; `start`: folder of the run whose networks it begins with,
    else they know nothing; `device`: where the networks are, in torch's words."""

    variant: str
    seed: int
    threads: int
    preset: Preset
    effects: Mapping[str, float] | None = None
    draws: Mapping[str, Any] | None = None
    against: str | None = None
    start: str | None = None
    device: str = "cpu"

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it."""
        return {**vars(self), "preset": self.preset.text}

    @classmethod
    def from_dict(cls, kept: Mapping[str, Any]) -> Settings:
        """What `as_dict` gave. ValueError, in one line, for anything else."""
        try:
            return cls(**{**kept, "preset": read_preset(kept["preset"], "of the run")})
        except (KeyError, TypeError) as error:
            raise ValueError(f"these are no settings of a run: {error}") from None


class Training:
    """A run in `folder`, taken up where its last checkpoint left it, if there is one."""

    def __init__(self, folder: RunFolder, settings: Settings) -> None:
        preset = against(settings.preset, settings.against) if settings.against else settings.preset
        if settings.effects or settings.draws:  # a table that leans to a side is no mirror image of itself
            preset = replace(preset, flip="none")
        self.preset = preset
        torch.set_num_threads(settings.threads)
        seed = settings.seed + RANKS_APART * ranks.rank()
        torch.manual_seed(seed)
        self.folder, self.settings = folder, settings
        self.rng = np.random.default_rng(settings.seed)
        self.hall, self.columns = _hall(preset, settings, seed)
        self.runner = SelfPlayRunner(self.hall, preset, ranks.own_device(settings.device))
        members = [Member(name) for name in preset.anchors]
        members += [Member(name, beside=_short(one.variant)) for one in preset.beside for name in one.anchors]
        self.league = League(members, preset.gate, preset.cap, preset.most)
        self.rows: list[Row] = []
        if folder.checkpoint.exists():
            saving.take_up(self)
            self._hold(self.steps)
        elif folder.policy.exists():
            way = f"a new run can begin with its player: --start {folder.policy}"
            raise ValueError(f"{folder.checkpoint} is missing, so that this run cannot go on; {way}")
        else:
            if settings.start:
                saving.learn_on(self, Path(settings.start))
            self._admit("self-0")
        self.taken_up = len(self.rows)  # rounds that were played before

    @property
    def steps(self) -> int:
        """Steps that the learner has taken, over all its seats."""
        return self.rows[-1]["steps"] if self.rows else 0

    def round(self) -> Row:
        """One round, and its checkpoint; what came of it."""
        met = [self._seat(part, beside) for part, beside in zip(self.hall.parts, self._besides(), strict=True)]
        iterations = [self.runner.iterate() for _ in range(self.preset.round)]
        tallies = [part.tally for part in self.hall.parts]
        points = np.concatenate([ranks.added(tally.points) for tally in tallies])
        games = np.concatenate([ranks.added(tally.games) for tally in tallies])
        everyone = [member for some in met for member in some]
        for member in dict.fromkeys(everyone):
            here = [block for block, one in enumerate(everyone) if one is member]
            member.note(points[here].sum(axis=0), games[here].sum(axis=0))
        self.runner.check_finite()
        chosen = met[0][len(self.preset.anchors) :]
        if chosen and self.league.wants_new(chosen):
            self._admit(f"self-{len(self.rows) + 1}")
        before = self.steps
        self.rows.append(self._row(iterations))
        self._hold(before)
        saving.save(self)
        return self.rows[-1]

    def _besides(self) -> list[str]:
        return ["", *(_short(one.variant) for one in self.preset.beside)]

    def _seat(self, part: LearnerEnv, beside: str) -> list[Member]:
        """Seat opponents for a round at the tables of a part: its anchors, and some chosen. Who they are, in order."""
        anchors = self.league.of(beside)
        seats = len(part.seating.blocks) - len(anchors)
        met = [*anchors, *(self.league.choose(seats, self.rng, beside) if seats else [])]
        part.seat(self._players(part, met), [member.share for member in met])
        part.tally.clear()
        return met

    def policy(self) -> Policy:
        """What has been learned so far."""
        about = {"variant": self.settings.variant, "seed": self.settings.seed, "steps": self.steps}
        return self.runner.policy(self.columns, about)

    def _hold(self, before: int) -> None:
        """Let hold what the preset has for now. The learning rate is changed only if that is new since `before` steps:
        a schedule may have moved it, and a checkpoint keeps it."""
        now = self.preset.at(self.steps)
        for part in self.hall.parts:
            part.rewards, part.gamma = now.rewards, now.ppo["gamma"]
        fresh = self.preset.at(before).ppo.get("learning_rate") != now.ppo.get("learning_rate")
        names = [name for name in CHANGEABLE if name in now.ppo and (fresh or name != "learning_rate")]
        self.runner.alg.hold({name: now.ppo[name] for name in names})

    def _players(self, part: LearnerEnv, met: list[Member]) -> list[Player]:
        seat = Seat.from_tables(part.tables)
        players = []
        for block, member in zip(part.seating.blocks, met, strict=True):
            own = replace(seat, tables=block.last - block.first, seed=int(self.rng.integers(2**31)))
            players.append(make_player(member.name, own) if member.policy is None else PolicyPlayer(member.policy, own))
        return players

    def _admit(self, name: str) -> None:
        policy = self.policy()
        if ranks.rank() == 0:
            policy.save(self.folder.selves / f"{name}.npz")
        self.league.admit(name, policy)

    def _row(self, iterations: list[Iteration]) -> Row:
        preset = self.preset
        before = self.rows[-1] if self.rows else {"steps": 0, "seconds": 0.0}
        spent = {part: sum(getattr(i, part) for i in iterations) for part in ("environment", "acting", "learning")}
        taken = self.hall.num_envs * preset.steps * preset.round * ranks.world()
        return {
            "round": len(self.rows) + 1,
            "steps": before["steps"] + taken,
            "seconds": round(before["seconds"] + sum(spent.values()), 2),
            "steps_per_s": round(taken / sum(spent.values())),
            **{part: round(seconds / sum(spent.values()), 3) for part, seconds in spent.items()},
            **{name: float(np.mean([i.losses[name] for i in iterations])) for name in iterations[0].losses},
            "scale": float(self.runner.alg.get_policy().output_std.detach().mean()),
            "selves": len(self.league.earlier),
            "rating": round(self.league.rating(), 1),
            **{f"points_{member.label}": round(member.share, 4) for member in self.league.anchors},
            **{f"wins_{member.label}": round(member.win_rate, 4) for member in self.league.anchors},
        }


def _hall(preset: Preset, settings: Settings, seed: int) -> tuple[Hall, list[str]]:
    """All tables that a run learns at, and the names of what its network reads."""
    sizes = [(settings.variant, preset.tables, [*preset.anchors.values(), *preset.earlier])]
    sizes += [(one.variant, one.tables, [*one.anchors.values(), *one.earlier]) for one in preset.beside]
    batches = [
        Tables(
            variant,
            tables,
            seed=seed + PARTS_APART * part,
            effects=as_content(settings.effects or {}),
            draws=settings.draws,
            threads=settings.threads,
        )
        for part, (variant, tables, _) in enumerate(sizes)
    ]
    for part, tables in enumerate(batches):
        stagger(tables, np.random.default_rng((settings.seed, ranks.rank(), part)))
    read, columns = readings(batches)
    parts = [
        LearnerEnv(
            tables, Seating.of(count, blocks, drill=tables.variant.game != MATCH), reading, preset.rewards,
            gamma=preset.ppo["gamma"], flip=preset.flip == "rows", critic=preset.critic,
        )
        for tables, reading, (_, count, blocks) in zip(batches, read, sizes, strict=True)
    ]  # fmt: skip
    return Hall(parts), columns


def _short(variant: str) -> str:
    return variant.removeprefix("puckpilot/")


def stagger(tables: Tables, rng: np.random.Generator) -> None:
    """Let the tables' games end at different times: begin each somewhere within its time."""
    rules = tables.variant
    longest = rules.step_limit or round(rules.match_time / rules.period)
    if longest < 200:  # drills are short enough to fall out of step by themselves
        return
    tables.states["steps"] = rng.integers(0, longest - 1, len(tables))
    tables.states["time"] = tables.states["steps"] * rules.period


def train(training: Training, *, steps: float, seconds: float, tell: Callable[[Row], None]) -> None:
    """Rounds until `steps` steps are taken or `seconds` are over, whichever comes first."""
    begun = time.monotonic()
    while training.steps < steps and not _anyone(time.monotonic() - begun > seconds):
        tell(training.round())


def _anyone(so: bool) -> bool:
    """Whether it is so in any process: all must end after the same round."""
    return bool(ranks.added(np.array([float(so)]))[0])
