"""What a diagnosis says of filmed games of the simulator, in which nothing is missing: rendered, tracked with a
calibration that is estimated anew for each, diagnosed.

    python -m tests.sim2real.vision.track.told [SECONDS [SEED…]]
"""

from __future__ import annotations

import sys
from itertools import islice

from puckpilot_env.parameters import TABLE
from sim2real.camera.frame import Frame
from sim2real.camera.moments import simulated
from sim2real.camera.render.renderer import Renderer
from sim2real.camera.render.table import Table as Scene
from sim2real.camera.render.view import View
from sim2real.diagnose.diagnosis import Diagnosis, diagnose
from sim2real.diagnose.summary import sentence
from sim2real.vision.calibrate.table_file import Table
from sim2real.vision.track.bright import LEVEL
from sim2real.vision.track.ring import HEIGHTS
from sim2real.vision.track.tracker import Things, Tracker
from sim2real.vision.trial.rendered_calibration import estimated
from tests.sim2real.vision.track.games import PLAYERS, RATE


def told(seconds: float, seed: int) -> Diagnosis:
    """Of one game and its calibration, both of this seed."""
    scene = Scene.with_markers()
    view = View.like_the_real_one(scene.length, scene.width)
    renderer = Renderer(scene, view, seed=seed)
    things = Things(scene.puck_radius, HEIGHTS["standard"], LEVEL)
    tracker = Tracker(Table.of(*estimated(scene, view, seed)), things)
    game = simulated("puckpilot/match-v0", PLAYERS, seed, RATE)
    for number, moment in enumerate(islice(game, int(seconds * RATE))):
        tracker.add(Frame(renderer.picture(moment, number), moment.time, moment.time, number))
    recording = tracker.recording(f"game {seed}", "tracked")
    return diagnose([recording], [], {row.name: row.default for row in TABLE}, lambda *_: None)


if __name__ == "__main__":
    lasts, seeds = float(sys.argv[1]) if len(sys.argv) > 1 else 60.0, [int(one) for one in sys.argv[2:]] or [1, 2, 3, 4]
    for seed in seeds:
        found = told(lasts, seed)
        print(f"game {seed}: {found.verdict}. {sentence(found)}", *found.remarks, sep="\n    ", flush=True)
