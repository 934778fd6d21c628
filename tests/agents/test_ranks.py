"""Two processes train one player over gloo: the same network and league on both, from games of their own."""

import json
import os
import subprocess
import sys
from pathlib import Path

import numpy as np

from tests.agents.tiny import TINY

LONGER = TINY.replace("steps = 4", "steps = 100")  # long enough for goals
ROOT = Path(__file__).resolve().parents[2]
TRAIN = """
import json, sys
from pathlib import Path
from agents import ranks
from agents.preset import read_preset
from agents.run_folder import RunFolder
from agents.training import Settings, Training
folder = Path(sys.argv[1])
run = RunFolder(folder)
if ranks.rank() == 0:
    run.begin({})
training = Training(run, Settings("match-v0", 3, 1, read_preset(sys.argv[2], "tiny")))
for _ in range(2):
    training.round()
league = training.league
told = {
    "weights": [p.tolist() for p in training.runner.alg.get_policy().parameters()],
    "places": training.hall.parts[0].tables.states["puck"]["x"].tolist(),
    "members": [[one.name, one.points.tolist(), one.games.tolist()] for one in [*league.anchors, *league.earlier]],
    "steps": training.steps,
}
(folder / f"rank{ranks.rank()}.json").write_text(json.dumps(told))
"""


def test_two_processes_keep_the_same_network_and_league(tmp_path):
    script = tmp_path / "train_twice.py"
    script.write_text(TRAIN)
    words = ["--standalone", "--nproc-per-node", "2", str(script), str(tmp_path), LONGER]
    environment = {"PYTHONPATH": str(ROOT), "OMP_NUM_THREADS": "1", **_path()}
    run = subprocess.run(
        [sys.executable, "-m", "torch.distributed.run", *words], env=environment, capture_output=True, text=True,
        timeout=300,
    )  # fmt: skip
    assert run.returncode == 0, run.stderr[-2000:]
    first, second = (json.loads((tmp_path / f"rank{k}.json").read_text()) for k in range(2))
    assert first["places"] != second["places"]
    for mine, other in zip(first["weights"], second["weights"], strict=True):
        assert mine == other and np.ptp(np.array(mine)) > 0.0
    assert first["members"] == second["members"] and sum(sum(points) for _, points, _ in first["members"]) > 0.0
    assert first["steps"] == second["steps"]
    assert (tmp_path / "checkpoint.pt").exists()


def _path() -> dict[str, str]:
    return {name: os.environ[name] for name in ("PATH", "HOME", "XDG_CACHE_HOME") if name in os.environ}
