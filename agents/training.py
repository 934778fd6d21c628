"""A training run: rounds of a league, each some updates against the same opponents, then a checkpoint.

A round seats its opponents anew, so that a checkpoint between rounds is all that there is to know: a run that was
killed goes on from its last round and, on one thread, takes the very same path.
"""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import torch

from agents import ranks
from agents.checkpoint import load_checkpoint, restore_tables, save_checkpoint, tables_as_tensors
from agents.exploit import against
from agents.league import League, Member
from agents.learner_env import LearnerEnv
from agents.policy import Policy, PolicyPlayer, load_policy
from agents.preset import CHANGEABLE, Preset, read_preset
from agents.run_folder import RunFolder
from agents.runner import Iteration, SelfPlayRunner
from agents.scaling import Reading, Scaling
from agents.seating import Seating
from agents.widen import widened
from baselines import make_player
from baselines.player import Player, Seat
from puckpilot_env.tables import Tables

RANKS_APART = 2**32  # between the seeds of processes that train together
Row = dict[str, Any]


@dataclass(frozen=True)
class Settings:
    """What is trained. `effects`: parameters of an effects file, or None; `against`: the one player that is met, else
    a league is; `start`: folder of the run whose networks it begins with, else they know nothing."""

    variant: str
    seed: int
    threads: int
    preset: Preset
    effects: Mapping[str, float] | None = None
    against: str | None = None
    start: str | None = None

    def as_dict(self) -> dict[str, Any]:
        """As JSON can hold it."""
        kept = {name: getattr(self, name) for name in ("variant", "seed", "threads", "effects", "against", "start")}
        return {**kept, "preset": self.preset.text}

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
        self.preset = preset
        torch.set_num_threads(settings.threads)
        seed = settings.seed + RANKS_APART * ranks.rank()
        torch.manual_seed(seed)
        self.folder, self.settings = folder, settings
        self.rng = np.random.default_rng(settings.seed)
        self.tables = Tables(settings.variant, preset.tables, seed=seed, parameters=settings.effects)
        stagger(self.tables, np.random.default_rng((settings.seed, ranks.rank())))
        seating = Seating.of(preset.tables, [*preset.anchors.values(), *preset.earlier])
        names = [column.name for column in self.tables.observation_columns]
        reading = Reading.of(Scaling.from_tables(self.tables), names, names)
        self.env = LearnerEnv(
            self.tables, seating, reading, preset.rewards, gamma=preset.ppo["gamma"], flip=preset.flip == "rows"
        )
        self.runner = SelfPlayRunner(self.env, preset)
        self.league = League([Member(name) for name in preset.anchors], preset.gate, preset.cap, preset.most)
        self.rows: list[Row] = []
        if folder.checkpoint.exists():
            self._read(folder.checkpoint, self._take_up)
            self._hold(self.steps)
        else:
            if settings.start:
                self._read(RunFolder(Path(settings.start)).checkpoint, self._learn_on)
            self._admit("self-0")

    @property
    def steps(self) -> int:
        """Steps that the learner has taken, over all its seats."""
        return self.rows[-1]["steps"] if self.rows else 0

    def round(self) -> Row:
        """One round, and its checkpoint; what came of it."""
        preset, tally = self.preset, self.env.tally
        chosen = self.league.choose(len(preset.earlier), self.rng)
        met = [*self.league.anchors, *chosen]
        self.env.seat(self._players(met), [member.share for member in met])
        tally.clear()
        iterations = [self.runner.iterate() for _ in range(preset.round)]
        points, games = ranks.added(tally.points), ranks.added(tally.games)
        for member in dict.fromkeys(met):
            here = [block for block, one in enumerate(met) if one is member]
            member.note(points[here].sum(axis=0), games[here].sum(axis=0))
        if chosen and self.league.wants_new(chosen):
            self._admit(f"self-{len(self.rows) + 1}")
        before = self.steps
        self.rows.append(self._row(iterations))
        self._hold(before)
        if ranks.rank() == 0:
            self._save()
        return self.rows[-1]

    def policy(self) -> Policy:
        """What has been learned so far."""
        about = {"variant": self.settings.variant, "seed": self.settings.seed, "steps": self.steps}
        return self.runner.policy(about)

    def _hold(self, before: int) -> None:
        """Let hold what the preset has for now. The learning rate is changed only if that is new since `before` steps:
        a schedule may have moved it, and a checkpoint keeps it."""
        now = self.preset.at(self.steps)
        self.env.rewards, self.env.gamma = now.rewards, now.ppo["gamma"]
        fresh = self.preset.at(before).ppo.get("learning_rate") != now.ppo.get("learning_rate")
        names = [name for name in CHANGEABLE if name in now.ppo and (fresh or name != "learning_rate")]
        self.runner.alg.hold({name: now.ppo[name] for name in names})

    def _players(self, met: list[Member]) -> list[Player]:
        seat = Seat.from_tables(self.tables)
        players = []
        for block, member in zip(self.env.seating.blocks, met, strict=True):
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
        taken = self.env.num_envs * preset.steps * preset.round * ranks.world()
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
            **{f"points_{member.name}": round(member.share, 4) for member in self.league.anchors},
            **{f"wins_{member.name}": round(member.win_rate, 4) for member in self.league.anchors},
        }

    def _save(self) -> None:
        self.policy().save(self.folder.policy)
        self.folder.write_curve(self.rows)
        league = self.league
        save_checkpoint(
            self.folder.checkpoint,
            {
                "learner": self.runner.alg.save(),
                "torch_random": torch.get_rng_state(),
                "random": json.dumps(self.rng.bit_generator.state),
                "tables": tables_as_tensors(self.tables),
                "rows": json.dumps(self.rows),
                "waited": league.waited,
                "anchors": [_as_dict(member) for member in league.anchors],
                "earlier": [_as_dict(member) for member in league.earlier],
            },
        )

    def _read(self, checkpoint: Path, use: Callable[[Mapping[str, Any]], None]) -> None:
        kept = load_checkpoint(checkpoint)
        try:
            use(kept)
        except (KeyError, IndexError, TypeError, AttributeError, RuntimeError) as error:  # torch says misfits many ways
            words = f"{type(error).__name__}: {error}".splitlines()[0]
            raise ValueError(f"the checkpoint {checkpoint} does not fit this run ({words})") from None

    def _learn_on(self, kept: Mapping[str, Any]) -> None:
        """Begin with another run's networks, and nothing else of it."""
        known = load_policy(RunFolder(Path(self.settings.start or "")).policy).columns
        learner = kept["learner"]
        for part in ("actor_state_dict", "critic_state_dict"):
            learner[part] = widened(learner[part], known, self.env.columns)
        self.runner.alg.load(learner, {"actor": True, "critic": True}, True)

    def _take_up(self, kept: Mapping[str, Any]) -> None:
        self.runner.alg.load(kept["learner"], None, True)
        self.rng.bit_generator.state = json.loads(kept["random"])
        if ranks.rank() == 0:  # the others' games begin anew
            torch.set_rng_state(kept["torch_random"])
            restore_tables(self.tables, kept["tables"])
        self.rows = json.loads(kept["rows"])
        self.runner.current_learning_iteration = len(self.rows) * self.preset.round
        league = self.league
        league.waited = kept["waited"]
        league.anchors = [_member(entry) for entry in kept["anchors"]]
        league.earlier = [
            _member(entry, load_policy(self.folder.selves / f"{entry['name']}.npz")) for entry in kept["earlier"]
        ]


def stagger(tables: Tables, rng: np.random.Generator) -> None:
    """Let the tables' games end at different times: begin each somewhere within its time."""
    rules = tables.variant
    longest = rules.step_limit or round(rules.match_time / rules.period)
    if longest < 200:  # drills are short enough to fall out of step by themselves
        return
    tables.states["steps"] = rng.integers(0, longest - 1, len(tables))
    tables.states["time"] = tables.states["steps"] * rules.period


def _as_dict(member: Member) -> dict[str, Any]:
    return {"name": member.name, "points": member.points.tolist(), "games": member.games.tolist()}


def _member(entry: Mapping[str, Any], policy: Policy | None = None) -> Member:
    return Member(entry["name"], policy, np.array(entry["points"]), np.array(entry["games"]))


def train(training: Training, *, steps: float, seconds: float, tell: Callable[[Row], None]) -> None:
    """Rounds until `steps` steps are taken or `seconds` are over, whichever comes first."""
    begun = time.monotonic()
    while training.steps < steps and not _anyone(time.monotonic() - begun > seconds):
        tell(training.round())


def _anyone(so: bool) -> bool:
    """Whether it is so in any process: all must end after the same round."""
    return bool(ranks.added(np.array([float(so)]))[0])
