"""PPO of rsl-rl in this project's league: against earlier selves and scripts at once, as `puckpilot train` does it."""

from __future__ import annotations

from dataclasses import replace

from agents.benchmark.algorithms import Algorithm, Assignment, Report
from agents.policy.policy import Policy
from agents.training.preset import find_preset
from agents.training.run import Training
from agents.training.run_folder import RunFolder
from agents.training.settings import Settings
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.variants import find_variant

ROUNDS = 10  # at least, where an update is no more than a tenth of the budget
PRESETS = {MATCH: "fast", ATTACK: "attack", DEFENCE: "defence"}  # by the variant's game


def learn(assignment: Assignment, report: Report) -> Policy:
    """Rounds of the preset, shorter ones where the budget is small, as many as fit into it; a report after each."""
    variant = find_variant(assignment.task.variant)
    preset = find_preset(PRESETS[variant.game])
    folder = RunFolder(assignment.folder)
    settings = Settings(variant.id, assignment.seed, 1, preset)
    folder.begin(settings.as_dict())
    training = Training(folder, settings)
    update = training.env.num_envs * preset.steps  # agent steps of both seats
    if update > assignment.steps:
        raise ValueError(f"it takes {update:,} steps for an update; {assignment.steps:,} are too few")
    updates = min(preset.round, max(1, assignment.steps // (ROUNDS * update)))
    training.preset = replace(training.preset, round=updates)
    while training.steps + updates * update <= assignment.steps:
        training.round()
        report(training.steps, training.policy())
    return training.policy()


ALGORITHM = Algorithm("PPO in a league of earlier selves and scripts", "rsl-rl", learn)
