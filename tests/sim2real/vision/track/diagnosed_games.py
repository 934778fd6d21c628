"""The diagnosis of filmed games of the simulator, in which nothing is missing: rendered, tracked with a
calibration that is estimated anew for each, diagnosed.

    python -m tests.sim2real.vision.track.diagnosed_games [SECONDS [SEED…]]
"""

from __future__ import annotations

import sys
from itertools import islice

from puckpilot_env.parameters import TABLE
from sim2real.camera.frame import Frame
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table
from sim2real.camera.render.view import CameraView
from sim2real.camera.scene_states import simulated_states
from sim2real.diagnose.pipeline import Diagnosis, diagnose
from sim2real.diagnose.report.summary import sentence
from sim2real.vision.calibrate.table_file import TableCalibration
from sim2real.vision.track.blobs import LEVEL
from sim2real.vision.track.ring import HEIGHTS
from sim2real.vision.track.tracker import Targets, Tracker
from sim2real.vision.trial.rendered_calibration import estimated_calibration
from tests.sim2real.vision.track.games import PLAYERS, RATE


def diagnosed(seconds: float, seed: int) -> Diagnosis:
    """Of one game and its calibration, both of this seed."""
    rendered = Table.with_markers()
    view = CameraView.like_the_real_one(rendered.length, rendered.width)
    renderer = Renderer(rendered, view, seed=seed)
    targets = Targets(rendered.puck_radius, HEIGHTS["standard"], LEVEL)
    tracker = Tracker(TableCalibration.of(*estimated_calibration(rendered, view, seed)), targets)
    game = simulated_states("puckpilot/match-v0", PLAYERS, seed, RATE)
    for number, state in enumerate(islice(game, int(seconds * RATE))):
        tracker.add(Frame(renderer.picture(state, number), state.time, state.time, number))
    recording = tracker.recording(f"game {seed}", "tracked")
    return diagnose([recording], [], {row.name: row.default for row in TABLE}, lambda *_: None)


if __name__ == "__main__":
    lasts, seeds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0, [int(one) for one in sys.argv[2:]] or [1, 2, 3, 4]
    for seed in seeds:
        found = diagnosed(lasts, seed)
        print(f"game {seed}: {found.verdict}. {sentence(found)}", *found.remarks, sep="\n    ", flush=True)
