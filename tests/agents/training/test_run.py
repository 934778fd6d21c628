"""Runs that stop, are killed, or fail: they resume exactly, or say why they cannot."""

from __future__ import annotations

import math
import resource
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
import torch

from agents.policy.policy import PolicyPlayer
from agents.training.preset import read_preset
from agents.training.run import Training
from agents.training.runner import DivergedError
from baselines.player import Seat
from puckpilot import main
from tests.agents.training.tiny import TINY, curve, files, tiny, training
from tests.places import ROOT


def arrays(path: Path) -> dict[str, np.ndarray]:
    with np.load(path) as file:
        return {name: file[name] for name in file.files}


def same_policies(one: Path, other: Path) -> bool:
    a, b = arrays(one), arrays(other)
    return list(a) == list(b) and all((a[name] == b[name]).all() for name in a)


def test_a_resumed_run_equals_an_unbroken_one(tmp_path: Path) -> None:
    unbroken = training(tmp_path / "a")
    for _ in range(4):
        unbroken.round()
    training(tmp_path / "b").round()
    for _ in range(3):
        training(tmp_path / "b", resume=True).round()
    rows = curve(tmp_path / "a")
    assert rows == curve(tmp_path / "b") and [row["round"] for row in rows] == ["1", "2", "3", "4"]
    assert len({row["value"] for row in rows}) == 4  # something is learned
    assert same_policies(tmp_path / "a" / "policy.npz", tmp_path / "b" / "policy.npz")
    names = [path.name for path in sorted((tmp_path / "a" / "selves").iterdir())]
    assert names == [path.name for path in sorted((tmp_path / "b" / "selves").iterdir())] and len(names) > 2
    assert all(same_policies(tmp_path / "a" / "selves" / n, tmp_path / "b" / "selves" / n) for n in names)


@pytest.mark.parametrize("variant", ["puckpilot/match-v0", "puckpilot/match-randomized-v0"])
def test_the_policy_file_plays_as_the_network_in_training(tmp_path: Path, variant: str) -> None:
    """The torch network's mean, scaled as in training, and the compiled player choose the same actions."""
    run = training(tmp_path, preset=tiny(flip="none"), variant=variant)
    run.round()
    player = PolicyPlayer(run.policy(), Seat.from_tables(run.env.envs[0].tables))
    rows = run.env.envs[0].matchmaking.learner_rows
    observed = run.env.envs[0].tables.observations.reshape(2 * len(run.env.envs[0].tables), -1)[rows]
    with torch.inference_mode():
        outputs = run.runner.alg.get_policy()(run.env.envs[0].get_observations()).numpy()
    assert np.abs(outputs).max() <= 1.0 and np.ptp(outputs, axis=0).min() > 0.0
    learned = run.env.envs[0].input_mapping.scaling.to_actions(outputs)
    np.testing.assert_allclose(player.act(observed), learned, rtol=1e-4, atol=1e-5)


LATER = """
[[later]]
from_steps = 300
ppo = { gamma = 0.8, entropy_coef = 0.0 }
rewards = { goal = 3.0 }

[[later]]
from_steps = 200
ppo = { learning_rate = 1e-5, gamma = 0.9 }
"""


def test_scheduled_changes_apply_from_their_step_on(tmp_path: Path) -> None:
    """128 steps a round; an adaptive learning rate is kept, and a resumed run has the same values."""
    preset = read_preset(TINY.replace("adaptive", "fixed") + LATER, "later")
    held = []
    for resumed in (False, True, True, True):
        run = training(tmp_path, preset=preset, resume=resumed)
        run.round()
        alg, env = run.runner.alg, run.env.envs[0]
        rates = {group["lr"] for group in alg.optimizer.param_groups}
        held.append((*rates, alg.learning_rate, alg.gamma, env.gamma, env.rewards.goal, alg.entropy_coef))
    first, second, third, fourth = held
    assert first == (1e-3, 1e-3, 0.95, 0.95, 1.0, first[-1]) and first[-1] > 0.0
    assert second == (1e-5, 1e-5, 0.9, 0.9, 1.0, first[-1])
    assert third == fourth == (1e-5, 1e-5, 0.8, 0.8, 3.0, 0.0)


def test_another_seed_gives_another_run(tmp_path: Path) -> None:
    one = training(tmp_path / "a")
    other = Training(one.folder, type(one.settings)("match-v0", 6, 1, tiny()))
    assert one.round()["value"] != other.round()["value"]


def test_steps_are_counted_over_the_learner_s_seats(tmp_path: Path) -> None:
    run = training(tmp_path)
    run.round()
    # 4 tables of self-play with two learners each, 8 with one; 4 steps, 2 updates
    assert run.round()["steps"] == 2 * (4 * 2 + 8) * 4 * 2 == run.steps


@pytest.mark.slow
def test_a_killed_run_resumes_and_a_running_one_is_locked(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    preset = tmp_path / "tiny.toml"
    preset.write_text(TINY.replace("steps = 4", "steps = 64"))
    words = ["train", "--preset", str(preset), "--seed", "5", "--out", str(tmp_path / "a")]
    code = "import sys; from puckpilot import main; sys.exit(main())"
    child = subprocess.Popen([sys.executable, "-c", code, *words], cwd=ROOT, stdout=subprocess.DEVNULL)
    try:
        until = time.monotonic() + 120.0
        while not (tmp_path / "a" / "checkpoint.pt").exists():
            assert child.poll() is None and time.monotonic() < until
            time.sleep(0.02)
        assert main(["train", "--resume", "--out", str(tmp_path / "a")]) == 2
        assert capsys.readouterr().err == f"puckpilot train: {tmp_path / 'a'} is in use by another run\n"
    finally:
        child.kill()
        child.wait()
    done = len(curve(tmp_path / "a"))
    each = 16 * 64 * 2  # steps of a round
    assert main(["train", "--resume", "--steps", str((done + 2) * each), "--out", str(tmp_path / "a")]) == 0
    whole = training(tmp_path / "b", preset=tiny(steps=64))
    for _ in range(len(curve(tmp_path / "a"))):
        whole.round()
    assert curve(tmp_path / "a") == curve(tmp_path / "b") and len(whole.rows) >= done + 2
    assert same_policies(tmp_path / "a" / "policy.npz", tmp_path / "b" / "policy.npz")


def test_a_full_disk_leaves_the_last_checkpoint_intact(tmp_path: Path) -> None:
    run = training(tmp_path / "a")
    run.round()
    before = (tmp_path / "a" / "checkpoint.pt").read_bytes()
    soft, hard = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) - 1, hard))  # the system then refuses, as for a full disk
    try:
        with pytest.raises(OSError, match="too large"):
            run.round()
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, (soft, hard))
    assert (tmp_path / "a" / "checkpoint.pt").read_bytes() == before
    assert not [name for name in files(tmp_path / "a") if ".tmp" in name]
    training(tmp_path / "a", resume=True).round()
    whole = training(tmp_path / "b")
    for _ in range(2):
        whole.round()
    assert curve(tmp_path / "a") == curve(tmp_path / "b")


def test_a_reward_of_nan_ends_the_run_and_leaves_its_files(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    run = training(tmp_path)
    run.round()
    before, honest = files(tmp_path), run.env.envs[0].step

    def broken(actions: torch.Tensor):
        seen, rewards, dones, extras = honest(actions)
        rewards[3] = math.nan
        return seen, rewards, dones, extras

    monkeypatch.setattr(run.env.envs[0], "step", broken)
    with pytest.raises(DivergedError):
        run.round()
    assert files(tmp_path) == before


def test_games_are_spread_over_their_length(tmp_path: Path) -> None:
    tables = training(tmp_path, preset=tiny(tables=60)).env.envs[0].tables
    assert tables.states["time"] == pytest.approx(tables.states["steps"] * 0.1)
    assert tables.states["time"].min() < 30.0 and 150.0 < tables.states["time"].max() < 180.0
