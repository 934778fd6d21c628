"""A hand lets the puck go, MuJoCo moves it, a camera looks on."""

from __future__ import annotations

import json
from math import cos, hypot, pi, sin
from pathlib import Path

import mujoco  # its classes are found at run time: pyright does not see them
import numpy as np

from sim2real.study.independent_table import Law
from sim2real.study.independent_table.recorder.camera import Camera, see
from sim2real.study.independent_table.recorder.record import SCENARIOS, meta, write_frames
from sim2real.study.independent_table.recorder.scene import FINE, HAND, Scene
from tests.mujoco_table.model import STEP, Settings, xml

SLOW, PATIENCE, FASTEST = 0.08, 8.0, 3.0  # m/s, s, m/s
RESTS = 0.05  # s, for which a puck is slow that is no longer going anywhere; a hit takes less


def fly(settings: Settings, start: tuple[float, float, float, float], seconds: float, spin: float = 0.0) -> np.ndarray:
    """Rows (n, 6) of x, y, vx, vy, angle, spin every FINE seconds from a start (x, y, vx, vy), the start first.

    Ends early in a goal, or where the puck has been slow for RESTS.
    """
    model = mujoco.MjModel.from_xml_string(xml(settings))  # pyright: ignore[reportAttributeAccessIssue] - mujoco is compiled
    data = mujoco.MjData(model)  # pyright: ignore[reportAttributeAccessIssue] - mujoco is compiled
    data.qpos[:2], data.qvel[:2], data.qvel[3] = start[:2], start[2:], spin
    rows, slow = np.empty((round(seconds / FINE), 6)), 0.0
    for k in range(len(rows)):
        x, y, _, angle = data.qpos
        vx, vy, _, turning = data.qvel
        rows[k] = x, y, vx, vy, angle, turning
        slow = slow + FINE if hypot(vx, vy) < SLOW else 0.0
        if not 0.0 < x < settings.length or slow > RESTS:
            return rows[:k]
        mujoco.mj_step(model, data, round(FINE / STEP))  # pyright: ignore[reportAttributeAccessIssue] - mujoco is compiled
    return rows


def play(settings: Settings, seed: int, seconds: float) -> Scene:
    """Launches from anywhere in any direction, until the time is over."""
    rng = np.random.default_rng(seed)
    path = np.full((round(seconds / FINE), 2), np.nan)
    at = 0
    while at < len(path):
        place = rng.uniform(0.1, 0.9) * settings.length, rng.uniform(0.15, 0.85) * settings.width
        speed, heading = FASTEST * rng.uniform(0.3, 1.0), rng.uniform(-pi, pi)
        rows = fly(settings, (*place, speed * cos(heading), speed * sin(heading)), PATIENCE)[: len(path) - at]
        path[at : at + len(rows)] = rows[:, :2]
        at += len(rows) + round(HAND / FINE)
    return Scene(np.arange(len(path)) * FINE, path, np.empty((0, len(path), 2)), [], [])


def make_recording(folder: Path, settings: Settings, seed: int, seconds: float, camera: Camera | None = None) -> Scene:
    """Write frames.csv and meta.json as for any recording of launches; return the truth."""
    camera = Camera() if camera is None else camera
    scene = play(settings, seed, seconds)
    folder.mkdir(parents=True, exist_ok=True)
    sizes = {name: getattr(settings, name) for name in ("length", "width", "goal_width", "puck_radius")}
    law = Law(**sizes)
    write_frames(folder, see(law, camera, scene, np.random.default_rng([seed, 1])))
    about = meta(law, camera, SCENARIOS["launches"])
    (folder / "meta.json").write_text(json.dumps(about, indent=1) + "\n", newline="\n")
    return scene
