"""Two processes train one player over gloo: the same network and league on both, different games on each."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from tests.agents.training.tiny import TINY
from tests.places import ROOT

pytestmark = pytest.mark.slow

LONGER = TINY.replace("steps = 4", "steps = 100")  # long enough for goals
TRAIN = """
import json, sys
from pathlib import Path
from agents.training import distributed
from agents.training.preset import read_preset
from agents.training.run_folder import RunFolder
from agents.training.run import Training
from agents.training.settings import Settings
folder = Path(sys.argv[1])
run = RunFolder(folder)
if distributed.rank() == 0 and not folder.exists():
    run.begin({})
training = Training(run, Settings("match-v0", 3, 1, read_preset(sys.argv[2], "tiny")))
while len(training.rows) < int(sys.argv[3]):
    training.round()
league = training.league
state = {
    "weights": [p.tolist() for p in training.runner.alg.get_policy().parameters()],
    "places": training.env.envs[0].tables.states["puck"]["x"].tolist(),
    "members": [[one.name, one.points.tolist(), one.games.tolist()] for one in [*league.anchors, *league.snapshots]],
    "steps": training.steps,
}
(folder / f"rank{distributed.rank()}.json").write_text(json.dumps(state))
"""


def trained(folder: Path, rounds: int) -> list[dict[str, Any]]:
    """States of two processes after `rounds` rounds of the run in `folder`, which is resumed if it exists."""
    script = folder.with_suffix(".py")
    script.write_text(TRAIN)
    words = ["--standalone", "--nproc-per-node", "2", str(script), str(folder), LONGER, str(rounds)]
    environment = {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", **_path()}
    run = subprocess.run(
        [sys.executable, "-m", "torch.distributed.run", *words], env=environment, capture_output=True, text=True,
        timeout=300,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr[-2000:]
    return [json.loads((folder / f"rank{k}.json").read_text()) for k in range(2)]


def test_two_processes_keep_the_same_network_and_league(tmp_path: Path) -> None:
    first, second = trained(tmp_path / "run", 2)
    assert first["places"] != second["places"]
    for mine, other in zip(first["weights"], second["weights"], strict=True):
        assert mine == other and np.ptp(np.array(mine)) > 0.0
    assert first["members"] == second["members"] and sum(sum(points) for _, points, _ in first["members"]) > 0.0
    assert first["steps"] == second["steps"]
    assert (tmp_path / "run" / "checkpoint.pt").exists()


@pytest.mark.long
def test_two_resumed_processes_equal_an_unbroken_run(tmp_path: Path) -> None:
    trained(tmp_path / "broken", 1)
    assert trained(tmp_path / "broken", 2) == trained(tmp_path / "unbroken", 2)


def _path() -> dict[str, str]:
    return {name: os.environ[name] for name in ("PATH", "HOME", "XDG_CACHE_HOME") if name in os.environ}
