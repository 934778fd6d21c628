"""PPO of rsl-rl in this project's league: against earlier selves and scripts at once, as `puckpilot train` does it."""

from __future__ import annotations

from agents.benchmark.algorithms import Algorithm, Assignment, Report
from agents.policy.policy import Policy
from agents.training.preset import find_preset
from agents.training.run import Training
from agents.training.run_folder import RunFolder
from agents.training.settings import Settings
from puckpilot_env.game.start import ATTACK, DEFENCE, MATCH
from puckpilot_env.variants import find_variant

PRESETS = {MATCH: "fast", ATTACK: "attack", DEFENCE: "defence"}  # by the variant's game


def learn(assignment: Assignment, report: Report) -> Policy:
    """Whole rounds of the preset, as many as fit into the steps; a report after each."""
    variant = find_variant(assignment.task.variant)
    preset = find_preset(PRESETS[variant.game])
    folder = RunFolder(assignment.folder)
    settings = Settings(variant.id, assignment.seed, 1, preset)
    folder.begin(settings.as_dict())
    training = Training(folder, settings)
    while True:
        begun = training.steps
        training.round()
        report(training.steps, training.policy())
        if training.steps + (training.steps - begun) > assignment.steps:
            return training.policy()


ALGORITHM = Algorithm("PPO in a league of earlier selves and scripts", "rsl-rl", learn)
