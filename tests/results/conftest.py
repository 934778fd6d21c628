"""Copies of a made-up repository whose published figures agree with its outputs."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from results.__main__ import main
from tests.results.made_up_house import README, RUNS, git


@pytest.fixture(scope="module")
def house_in_order(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A repository with three runs, their outputs and a README that agrees with them."""
    root = tmp_path_factory.mktemp("results") / "house"
    (root / "results").mkdir(parents=True)
    (root / "results" / "runs.toml").write_text(RUNS)
    (root / "README.md").write_text(README)
    (root / "code.py").write_text("")
    git(root, "init", "-q")
    git(root, "add", ".")
    git(root, "commit", "-qm", "first")
    assert main(["run"], root) == 0 and main(["page"], root) == 0
    return root


@pytest.fixture
def house(house_in_order: Path, tmp_path: Path) -> Path:
    """A copy of it."""
    return shutil.copytree(house_in_order, tmp_path / "house")
