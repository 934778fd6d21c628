"""Make the bundled demo recording: `python -m sim2real.study.independent_table.make_demo sim2real/demo_recording`.

A minute of a robot that rallies with a puck on a table that is slightly tilted and whose walls spin the puck:
two effects that the simulator's baseline law does not contain.
"""

from __future__ import annotations

import argparse
from collections.abc import Sequence
from pathlib import Path

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera
from sim2real.study.independent_table.recorder.record import make_recording
from sim2real.study.independent_table.recorder.scene import Scene

LAW = Law(wall_spin=True, wall_mu=0.15, spin_decay=0.3, tilt_x=0.02, tilt_y=-0.012)
SEED, SECONDS = 7, 60.0
NOTE = "demo: a robot rallies with a puck; synthetic, made by sim2real/study/independent_table/make_demo.py"


def make_demo(folder: Path) -> Scene:
    """Write the recording and return the true scene."""
    camera = Camera(rate=120.0, noise=0.0005)
    return make_recording(folder, LAW, "rally", SEED, SECONDS, camera, encoder_rate=200.0, note=NOTE)


def main(arguments: Sequence[str] | None = None) -> None:
    """Write the bundled demo recording to the folder that is given."""
    parser = argparse.ArgumentParser(description="write the bundled demo recording")
    parser.add_argument("folder", type=Path, help="where meta.json, frames.csv, mallet.csv and commands.csv go")
    make_demo(parser.parse_args(arguments).folder)


if __name__ == "__main__":
    main()
