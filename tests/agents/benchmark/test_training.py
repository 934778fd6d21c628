"""One training of the benchmark: kept, taken up again, and its policy is what the learner had learnt."""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import torch
from stable_baselines3 import PPO, SAC
from stable_baselines3.common.vec_env import VecNormalize

from agents.benchmark.algorithms import Algorithm, Assignment, Report, _sb3, algorithm_names, find_algorithm
from agents.benchmark.protocol import read_protocol
from agents.benchmark.training import TrainingJob, jobs_of, run_job
from agents.policy.policy import PolicyPlayer, load_policy
from agents.training.run_folder import RunFolder
from baselines.player import Seat
from baselines.sb3_vec_env import make_sb3_vec_env
from puckpilot_env.tables import Tables

PROTOCOL = read_protocol()
DRILL = PROTOCOL.tasks["attack-v0"]


@pytest.fixture(autouse=True)
def _short(monkeypatch: pytest.MonkeyPatch) -> None:
    """Evaluations of a few games."""
    monkeypatch.setattr("agents.benchmark.training.read_protocol", lambda: replace(PROTOCOL, games=4))
    monkeypatch.setattr("agents.benchmark.training.CURVE_GAMES", 2)


def test_every_algorithm_says_what_it_is() -> None:
    assert {"random", "interceptor", "league_ppo", "sb3_ppo", "sb3_sac", "torchrl_ippo"} <= set(algorithm_names())
    assert all(find_algorithm(name).words and find_algorithm(name).library for name in algorithm_names())
    with pytest.raises(ValueError, match=r"unknown algorithm 'sb3_pp'; did you mean 'sb3_ppo'\?"):
        find_algorithm("sb3_pp")


def test_what_does_not_learn_is_played_once_for_each_task(tmp_path: Path) -> None:
    jobs = jobs_of(["random", "sb3_ppo"], PROTOCOL.chosen(["attack-v0", "defence-v0"]), 3, 10, tmp_path)
    assert [(job.algorithm, job.seed, job.steps) for job in jobs].count(("random", 0, 0)) == 2
    assert len(jobs) == 2 + 2 * 3 and {job.steps for job in jobs[2:]} == {10}


def test_an_outcome_is_kept_and_an_unfinished_one_begins_anew(tmp_path: Path) -> None:
    job = TrainingJob("random", DRILL, 0, 1000, tmp_path)
    half = job.folder / "meanwhile" / "half"
    half.parent.mkdir(parents=True)
    half.write_text("of one that was killed", encoding="utf-8")
    first = run_job(job)
    assert [row["opponent"] for row in first["evaluation"]] == [*DRILL.opponents, PROTOCOL.kept_out]
    assert first["protocol"] == PROTOCOL.hash and not half.exists()
    changed = {**first, "version": "as it was"}
    job.outcome.write_text(json.dumps(changed), encoding="utf-8")
    assert run_job(job) == changed  # not played again
    with pytest.raises(ValueError, match=r"outcome.json is of budget 1000, not 2000; name another --out"):
        run_job(replace(job, steps=2000))


def test_a_training_that_another_process_works_at_is_left_alone(tmp_path: Path) -> None:
    job = TrainingJob("random", DRILL, 0, 0, tmp_path)
    with RunFolder(job.folder).locked(), pytest.raises(ValueError, match=r"seed_0 is in use by another run"):
        run_job(job)


def test_who_takes_more_steps_than_the_budget_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def greedy(assignment: Assignment, report: Report) -> str:
        report(assignment.steps + 1, "still")
        return "still"

    monkeypatch.setattr("agents.benchmark.training.find_algorithm", lambda name: Algorithm("", "none", greedy))
    with pytest.raises(ValueError, match=r"greedy took 1,001 agent steps of a budget of 1,000"):
        run_job(TrainingJob("greedy", DRILL, 0, 1000, tmp_path))


@pytest.mark.slow
@pytest.mark.parametrize(
    ("algorithm", "steps"), [("sb3_ppo", 20_000), ("league_ppo", 40_000), ("torchrl_mappo", 20_000)]
)
def test_a_learner_leaves_its_curve_and_its_policy(algorithm: str, steps: int, tmp_path: Path) -> None:
    job = TrainingJob(algorithm, DRILL, 1, steps, tmp_path)
    outcome = run_job(job)
    assert 0.5 * steps < outcome["steps"] <= steps and outcome["seconds"] > 0.0
    assert all(list(point["scores"]) == list(DRILL.opponents) for point in outcome["curve"])
    policy = load_policy(job.folder / "policy.npz")
    about = policy.about
    assert (about["variant"], about["seed"], about["steps"]) == (DRILL.variant, 1, outcome["steps"])
    assert sorted(path.name for path in job.folder.iterdir()) == [".lock", "outcome.json", "policy.npz"]
    with pytest.raises(ValueError, match=r"it takes [0-9,]+ steps for an update; 100 are too few"):
        run_job(replace(job, steps=100, seed=2))


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["ppo", "sac"])
def test_a_policy_acts_as_the_learner_of_the_library_does(kind: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Against the library's own `predict`, whose actions are shares of the action space."""
    envs = VecNormalize(make_sb3_vec_env(DRILL.variant, 8, opponent="still"))
    if kind == "ppo":
        model = PPO("MlpPolicy", envs, n_steps=32, batch_size=64, seed=2,
                    policy_kwargs={"net_arch": [16, 16], "activation_fn": torch.nn.ReLU})  # fmt: skip
        layers, squash = [*model.policy.mlp_extractor.policy_net, model.policy.action_net], "clip"
    else:
        model = SAC("MlpPolicy", envs, learning_starts=64, seed=2, policy_kwargs={"net_arch": [16, 16]})
        layers, squash = [*model.policy.actor.latent_pi, model.policy.actor.mu], "tanh"
    model.learn(512)
    tables = Tables(DRILL.variant, 50, seed=3)
    player = PolicyPlayer(_sb3.as_policy(tables, envs, layers, squash, {}), Seat.from_tables(tables))
    seen = tables.observations[:, 0]
    shares, _ = model.predict(envs.normalize_obs(seen), deterministic=True)
    low, high = tables.action_bounds
    expected = low + 0.5 * (np.clip(shares, -1.0, 1.0) + 1.0) * (high - low)
    assert np.ptp(expected, axis=0).min() > 1e-4  # the network looks at what it sees
    assert player.act(seen) == pytest.approx(expected, abs=2e-4)
