"""A training run: rounds of some updates against the same opponents, with a checkpoint after each.

Each round draws its opponents anew, so a checkpoint between rounds holds the whole state. A run that was killed resumes
from its last round and, on one thread, continues exactly as it would have.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import torch

from agents.env.learner_env import LearnerEnv
from agents.env.multi_variant_env import MultiVariantVectorEnv, input_mappings
from agents.league.league import League, Member
from agents.league.matchmaking import Matchmaking
from agents.policy.policy import Policy, PolicyPlayer
from agents.training import distributed
from agents.training.preset import SCHEDULABLE, Preset
from agents.training.run_folder import RunFolder
from agents.training.run_state import resume_run, save_run
from agents.training.runner import Iteration, SelfPlayRunner
from agents.training.settings import Settings
from agents.training.warm_start import warm_start
from baselines import make_player
from baselines.player import Player, Seat
from puckpilot_env.game.start import MATCH
from puckpilot_env.options.effects_file import as_content
from puckpilot_env.parameters import EFFECT_ROWS, TABLE
from puckpilot_env.residual.network import load_residual
from puckpilot_env.residual.tables import ResidualTables
from puckpilot_env.tables import Tables

PROCESS_SEED_STEP = 2**32  # between the seeds of processes that train together
VARIANT_SEED_STEP = 2**48  # between the seeds of the variants of one run
DESYNCHRONIZED_STEPS = 200  # shorter episodes get out of step by themselves
BASELINE = {row.name for row in TABLE} - {row.name for row in EFFECT_ROWS}
Row = dict[str, Any]


class Training:
    """A run in `folder`, resumed from its checkpoint if there is one.

    `rows` has a row of the learning curve for each round; `resumed_rounds` of them were played before.
    """

    def __init__(self, folder: RunFolder, settings: Settings) -> None:
        """ValueError, in one line, for settings that cannot be trained or that contradict the checkpoint."""
        preset = settings.preset.against(settings.against) if settings.against else settings.preset
        if _may_lean(settings):
            preset = replace(preset, flip="none")
        self.preset = preset
        torch.set_num_threads(settings.threads)
        seed = settings.seed + PROCESS_SEED_STEP * distributed.rank()
        torch.manual_seed(seed)
        self.folder, self.settings = folder, settings
        self.rng = np.random.default_rng(settings.seed)
        self.env, self.columns = _make_env(preset, settings, seed)
        self.runner = SelfPlayRunner(self.env, preset, distributed.local_device(settings.device))
        self.league = _make_league(preset)
        self.rows: list[Row] = []
        if folder.checkpoint.exists():
            resume_run(self)
            self._apply_schedule(self.steps)
        elif folder.policy.exists():
            advice = f"a new run can begin with its player: --start {folder.policy}"
            raise ValueError(f"{folder.checkpoint} is missing, so that this run cannot go on; {advice}")
        else:
            if settings.start:
                warm_start(self, Path(settings.start))
            self._add_snapshot("self-0")
        self.resumed_rounds = len(self.rows)

    @property
    def steps(self) -> int:
        """Steps that the learner has taken, summed over its seats and all processes."""
        return self.rows[-1]["steps"] if self.rows else 0

    def policy(self) -> Policy:
        """The learner's present policy."""
        about = {"variant": self.settings.variant, "seed": self.settings.seed, "steps": self.steps}
        return self.runner.policy(self.columns, about)

    def round(self) -> Row:
        """Play one round and save the run; returns the round's row of the learning curve."""
        variants = ["", *(_short_id(extra.variant) for extra in self.preset.beside)]
        opponents = [self._set_opponents(env, extra) for env, extra in zip(self.env.envs, variants, strict=True)]
        critic_alone = len(self.rows) < self.preset.critic_rounds
        iterations = [self.runner.iterate(critic_alone) for _ in range(self.preset.round)]
        self._update_league([member for members in opponents for member in members])
        self.runner.check_finite()
        drawn = opponents[0][len(self.preset.anchors) :]
        if drawn and self.league.should_snapshot(drawn):
            self._add_snapshot(f"self-{len(self.rows) + 1}")
        steps_before = self.steps
        self.rows.append(self._row(iterations))
        self._apply_schedule(steps_before)
        save_run(self)
        return self.rows[-1]

    def _set_opponents(self, env: LearnerEnv, extra_variant: str) -> list[Member]:
        """Set the opponents of a round: the variant's anchors, then some drawn. Returns them in the order of blocks."""
        anchors = self.league.anchors_of(extra_variant)
        count = len(env.matchmaking.blocks) - len(anchors)
        members = [*anchors, *(self.league.sample_opponents(count, self.rng, extra_variant) if count else [])]
        env.set_opponents(self._make_players(env, members), [member.point_share for member in members])
        env.results.clear()
        return members

    def _make_players(self, env: LearnerEnv, members: list[Member]) -> list[Player]:
        seat = Seat.from_tables(env.tables)
        players: list[Player] = []
        for block, member in zip(env.matchmaking.blocks, members, strict=True):
            own = replace(seat, tables=block.last - block.first, seed=int(self.rng.integers(2**31)))
            players.append(make_player(member.name, own) if member.policy is None else PolicyPlayer(member.policy, own))
        return players

    def _update_league(self, members: list[Member]) -> None:
        """Add the round's results in all blocks to `members`, one for each block; a member may have several blocks."""
        results = [env.results for env in self.env.envs]
        points = np.concatenate([distributed.sum_over_processes(one.points) for one in results])
        games = np.concatenate([distributed.sum_over_processes(one.games) for one in results])
        for member in dict.fromkeys(members):
            blocks = [block for block, one in enumerate(members) if one is member]
            member.add_results(points[blocks].sum(axis=0), games[blocks].sum(axis=0))

    def _apply_schedule(self, steps_before: int) -> None:
        """Set rewards and hyperparameters to the preset's values at this number of steps.

        The learning rate is set only where the preset changes it after `steps_before`: rsl-rl's adaptive schedule may
        have moved it since, and a checkpoint holds it.
        """
        now = self.preset.at(self.steps)
        for env in self.env.envs:
            env.rewards, env.gamma = now.rewards, now.ppo["gamma"]
        new_rate = self.preset.at(steps_before).ppo.get("learning_rate") != now.ppo.get("learning_rate")
        names = [name for name in SCHEDULABLE if name in now.ppo and (new_rate or name != "learning_rate")]
        self.runner.alg.set_hyperparameters({name: now.ppo[name] for name in names})

    def _add_snapshot(self, name: str) -> None:
        policy = self.policy()
        if distributed.rank() == 0:
            policy.save(self.folder.selves / f"{name}.npz")
        self.league.add_snapshot(name, policy)

    def _row(self, iterations: list[Iteration]) -> Row:
        preset = self.preset
        before = self.rows[-1] if self.rows else {"steps": 0, "seconds": 0.0}
        spent = {part: sum(getattr(i, part) for i in iterations) for part in ("environment", "acting", "learning")}
        taken = self.env.num_envs * preset.steps * preset.round * distributed.world_size()
        return {
            "round": len(self.rows) + 1,
            "steps": before["steps"] + taken,
            "seconds": round(before["seconds"] + sum(spent.values()), 2),
            "steps_per_s": round(taken / sum(spent.values())),
            **{part: round(seconds / sum(spent.values()), 3) for part, seconds in spent.items()},
            **{name: float(np.mean([i.losses[name] for i in iterations])) for name in iterations[0].losses},
            "scale": float(self.runner.alg.get_policy().output_std.detach().mean()),
            "selves": len(self.league.snapshots),
            "rating": round(self.league.rating(), 1),
            **{f"points_{member.label}": round(member.point_share, 4) for member in self.league.anchors},
            **{f"wins_{member.label}": round(member.win_rate, 4) for member in self.league.anchors},
        }


def train(training: Training, *, steps: float, seconds: float, report: Callable[[Row], None]) -> None:
    """Play rounds until `steps` steps are taken or `seconds` [s] have passed; `report` gets the row of each round."""
    begun = time.monotonic()
    while training.steps < steps and not _in_any_process(time.monotonic() - begun > seconds):
        report(training.round())


def stagger(tables: Tables, rng: np.random.Generator) -> None:
    """Start each table's game at a random time of its length, so that the games do not all end together."""
    variant = tables.variant
    length = variant.step_limit or round(variant.match_time / variant.period)
    if length < DESYNCHRONIZED_STEPS:
        return
    tables.states["steps"] = rng.integers(0, length - 1, len(tables))
    tables.states["time"] = tables.states["steps"] * variant.period


def _make_league(preset: Preset) -> League:
    anchors = [Member(name) for name in preset.anchors]
    anchors += [Member(name, extra_variant=_short_id(one.variant)) for one in preset.beside for name in one.anchors]
    return League(anchors, preset.gate, preset.cap, preset.most)


def _make_env(preset: Preset, settings: Settings, seed: int) -> tuple[MultiVariantVectorEnv, list[str]]:
    """The environment with the tables of all variants, and the names of the network's inputs."""
    sizes = [(settings.variant, preset.tables, [*preset.anchors.values(), *preset.earlier])]
    sizes += [(one.variant, one.tables, [*one.anchors.values(), *one.earlier]) for one in preset.beside]
    make = partial(ResidualTables, residual=load_residual(Path(settings.residual))) if settings.residual else Tables
    batches = [
        make(
            variant, count, seed=seed + VARIANT_SEED_STEP * number, effects=as_content(settings.effects or {}),
            draws=settings.draws, threads=settings.threads,
        )
        for number, (variant, count, _) in enumerate(sizes)
    ]  # fmt: skip
    for number, tables in enumerate(batches):
        stagger(tables, np.random.default_rng((settings.seed, distributed.rank(), number)))
    mappings, columns = input_mappings(batches)
    envs = [
        LearnerEnv(
            tables, _matchmaking(tables, blocks), mapping,
            preset.rewards, gamma=preset.ppo["gamma"], mirror=preset.flip == "rows", critic=preset.critic,
        )
        for tables, mapping, (_, _, blocks) in zip(batches, mappings, sizes, strict=True)
    ]  # fmt: skip
    return MultiVariantVectorEnv(envs), columns


def _matchmaking(tables: Tables, blocks: list[int]) -> Matchmaking:
    """The seats of a batch. Where player 1 has its mallet in a hand the learner plays the other one alone, and in place
    of self-play the last block is larger. ValueError, in one line, if there is none."""
    count, by_hand = len(tables), bool(tables.nominal["hand"][0])
    if by_hand:
        if not blocks:
            raise ValueError("a table with a hand has no self-play; expected a preset with anchors or earlier selves")
        blocks = [*blocks[:-1], max(count - sum(blocks[:-1]), blocks[-1])]
    return Matchmaking.from_block_sizes(count, blocks, one_seat=by_hand or tables.variant.game != MATCH)


def _may_lean(settings: Settings) -> bool:
    """Whether the table may be no mirror image of itself, left for right: only the baseline and what is true of every
    table always are."""
    return bool(settings.draws or settings.residual or set(settings.effects or {}) - BASELINE)


def _short_id(variant: str) -> str:
    return variant.removeprefix("puckpilot/")


def _in_any_process(condition: bool) -> bool:
    """Whether `condition` holds in any process: all processes must end after the same round."""
    return bool(distributed.sum_over_processes(np.array([float(condition)]))[0])
