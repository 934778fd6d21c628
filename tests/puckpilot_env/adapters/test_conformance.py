"""Every id passes all of PettingZoo's own tests, with their warnings as errors, and our stronger checks."""

from __future__ import annotations

import importlib
import inspect
import re
import warnings
from itertools import count
from pathlib import Path
from types import SimpleNamespace

import pettingzoo
import pytest
from pettingzoo.test import (
    api_test,
    max_cycles_test,
    parallel_api_test,
    parallel_seed_test,
    render_test,
    seed_test,
)
from pettingzoo.test.save_obs_test import check_save_obs
from pettingzoo.test.state_test import state_test

import puckpilot_env
from puckpilot_env import all_variants
from puckpilot_env.check import run_checks
from puckpilot_env.rendering.window import Window

IDS = list(all_variants())
WHOLE_MATCH = 1850  # steps: one of 180 s and the beginning of another


@pytest.fixture(autouse=True)
def reproducible(monkeypatch):
    """Upstream resets without a seed and then counts steps, which chance can cut short (a drill ends early).

    Each environment gets another seed, lest two that ignore theirs look alike.
    """
    monkeypatch.setattr("puckpilot_env.adapters.parallel_env.fresh_seed", count(12345).__next__)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


def seeded(make):
    """`make` with seeded action spaces: upstream samples from them without seeding them."""

    def made(**options):
        env = make(**options)
        for i, agent in enumerate(env.possible_agents):
            env.action_space(agent).seed(i)
        return env

    return made


def module_of(id_):
    """The variant's module as upstream's tests take it, its environments seeded."""
    module = importlib.import_module(f"puckpilot_env.{all_variants()[id_].module}")
    return SimpleNamespace(env=seeded(module.env), parallel_env=seeded(module.parallel_env), raw_env=module.raw_env)


def test_every_file_is_registered():
    """The list of ids comes from the files, so a registry that lost one would otherwise go unnoticed."""
    files = [p.stem for p in Path(inspect.getfile(puckpilot_env)).parent.glob("*.py") if re.search(r"_v\d+$", p.stem)]
    assert len(IDS) == len(files) >= 7
    assert set(IDS) <= set(pettingzoo.parallel_registry) & set(pettingzoo.aec_registry)


@pytest.mark.parametrize("id_", IDS)
def test_api(id_):
    api_test(module_of(id_).env(), num_cycles=400)
    api_test(pettingzoo.make("aec", id_), num_cycles=50)


@pytest.mark.parametrize("id_", IDS)
def test_parallel_api(id_):
    parallel_api_test(module_of(id_).parallel_env(), num_cycles=2000)
    parallel_api_test(pettingzoo.make("parallel", id_), num_cycles=50)


@pytest.mark.parametrize("id_", IDS)
def test_seeds(id_):
    parallel_seed_test(module_of(id_).parallel_env)
    seed_test(module_of(id_).env, num_cycles=200)


@pytest.mark.parametrize("id_", IDS)
def test_max_cycles(id_):
    max_cycles_test(module_of(id_))


@pytest.mark.parametrize("id_", IDS)
def test_state(id_):
    state_test(module_of(id_).env(), module_of(id_).parallel_env(), num_cycles=200)


@pytest.mark.parametrize("id_", IDS)
def test_observations_are_no_images(id_):
    """Upstream's test_save_obs is for observations that are images; elsewhere it passes without a word."""
    env = module_of(id_).env()
    env.reset()
    with pytest.raises(AssertionError, match="Observations must be 0 to 255 to save as image"):
        check_save_obs(env)


class Unhurried:
    """A clock that waits for no picture."""

    def tick(self, fps: float) -> None:
        assert fps == Window.fps


@pytest.mark.parametrize("id_", IDS)
def test_render(id_, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setenv("SDL_VIDEODRIVER", "dummy")
    monkeypatch.setattr("pygame.time.Clock", Unhurried)
    render_test(module_of(id_).env)  # pyright: ignore[reportArgumentType] - its annotation forgets render_mode


@pytest.mark.slow
@pytest.mark.parametrize("id_", IDS)
def test_own_checks(id_):
    steps = WHOLE_MATCH if "match" in id_ else 400
    found = [str(result) for result in run_checks(id_, steps=steps) if not result.passed]
    assert found == []
