"""Recordings in the format puckpilot-recording/1, made by the reference table."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from tests.reality.camera import Camera, look_up, see
from tests.reality.law import Law
from tests.reality.scene import Scene, play

SCENARIOS = {
    "launches": (0, "puck launched by hand, no mallets on the table"),
    "rally": (1, "robot against the puck; a hand relaunches it"),
    "match": (2, "robot against a hand-held mallet"),
}


def make_recording(
    folder: Path | str,
    law: Law,
    scenario: str,
    seed: int,
    seconds: float,
    camera: Camera | None = None,
    encoder_rate: float = 500.0,
    encoder_noise: float = 0.0001,
    fastest: float = 3.0,
    note: str | None = None,
) -> Scene:
    """Write meta.json, frames.csv and, where a robot moves, mallet.csv and commands.csv; return the truth.

    `scenario`: launches, rally or match. `law.camera_*` distort what is seen; `camera` says how noisily. The same
    arguments give the same bytes.
    """
    if scenario not in SCENARIOS:
        raise ValueError(f"unknown scenario {scenario!r}: expected one of {', '.join(SCENARIOS)}")
    players, words = SCENARIOS[scenario]
    camera = Camera() if camera is None else camera
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    scene = play(law, seed, seconds, players, fastest)
    rng = np.random.default_rng([seed, 1])
    stamps, puck, opponent = see(law, camera, scene, rng)
    frames = (
        f"{t:.6f},{cell(x, 5)},{cell(y, 5)},{cell(ox, 5)},{cell(oy, 5)}"
        for t, (x, y), (ox, oy) in zip(stamps, puck, opponent, strict=True)
    )
    write(folder / "frames.csv", "t,puck_x,puck_y,opponent_x,opponent_y", frames)
    if players:
        t = np.arange(round(seconds * encoder_rate)) / encoder_rate
        t = t[t <= scene.t[-1]]
        path = look_up(t, scene.mallets[0]) + encoder_noise * rng.standard_normal((len(t), 2))
        rows = (f"{time:.4f},{x:.5f},{y:.5f}" for time, (x, y) in zip(t, path, strict=True))
        write(folder / "mallet.csv", "t,mallet_x,mallet_y", rows)
        commands = (",".join(f"{value:.6f}" for value in row) for row in scene.commands)
        write(folder / "commands.csv", "t,x_f,y_f,V_x,V_y,t_x1,t_y1,t_x2,t_y2", commands)
    (folder / "meta.json").write_text(json.dumps(meta(law, camera, note or words), indent=1) + "\n", newline="\n")
    return scene


def meta(law: Law, camera: Camera, note: str) -> dict[str, object]:
    """What the maker of a recording knows: sizes, and the camera's nominal figures. No law, no hidden effect."""
    return {
        "format": "puckpilot-recording/1",
        "table": {"length_m": law.length, "width_m": law.width, "goal_width_m": law.goal_width},
        "puck": {"radius_m": law.puck_radius},
        "mallet": {"radius_m": law.mallet_radius},
        "camera": {"rate_hz": camera.rate, "position_std_m": camera.noise},
        "note": note,
    }


def cell(value: float, digits: int) -> str:
    """A number, or a blank for what was not seen."""
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def write(path: Path, header: str, rows: Iterable[str]) -> None:
    path.write_text("\n".join([header, *rows]) + "\n", newline="\n")
