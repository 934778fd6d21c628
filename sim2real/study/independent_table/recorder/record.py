"""Recordings in the format puckpilot-recording/1, made by the reference table."""

from __future__ import annotations

import json
from collections.abc import Iterable
from pathlib import Path

import numpy as np

from sim2real.study.independent_table.physics.law import Law
from sim2real.study.independent_table.recorder.camera import Camera, look_up, see
from sim2real.study.independent_table.recorder.roam import LOOP, roam
from sim2real.study.independent_table.recorder.scene import FINE, Hand, Scene, play

ALONE = "puck launched by hand, no mallets on the table"
GANTRY = "robot mallet alone, no puck"
# name: the note in such a recording. Posts: launches aimed at them. Drive: a log of the motors.
SCENARIOS = {
    "launches": ALONE,
    "posts": ALONE,
    "rally": "robot against the puck; a hand relaunches it",
    "match": "robot against a hand-held mallet",
    "gantry": GANTRY,
    "drive": GANTRY,
}
PLAYERS = {"launches": 0, "posts": 0, "rally": 1, "match": 2}
AT_POSTS = Hand(patience=4.0, at_posts=True)
SUPPLY = 24.0  # V
SHARP = 1e-4  # m, noise below which the rounding to ten micrometres matters


def make_recording(
    folder: Path | str,
    law: Law,
    scenario: str,
    seed: int,
    seconds: float,
    camera: Camera | None = None,
    encoder_rate: float = 500.0,
    encoder_noise: float = 0.0001,
    hand: Hand | None = None,
    note: str | None = None,
    dt: float = 1e-5,
) -> Scene:
    """Write meta.json, frames.csv and, where a robot moves, mallet.csv and commands.csv or drive.csv; return the truth.

    `law.camera_*` and `law.encoder_clock` distort the recorded data; `camera` adds noise. The encoders measure the
    mallet itself, not its motors. The same arguments give the same bytes.
    """
    if scenario not in SCENARIOS:
        raise ValueError(f"unknown scenario {scenario!r}: expected one of {', '.join(SCENARIOS)}")
    camera = Camera() if camera is None else camera
    folder = Path(folder)
    folder.mkdir(parents=True, exist_ok=True)
    rng = np.random.default_rng([seed, 1])
    if scenario in PLAYERS:
        scene = play(law, seed, seconds, PLAYERS[scenario], hand or (AT_POSTS if scenario == "posts" else None), dt)
        write_frames(folder, see(law, camera, scene, rng), 6 if camera.noise < SHARP else 5)
    else:
        scene = roam(law, seed, seconds, scenario == "drive", dt)
        write_frames(folder)
    if len(scene.mallets):
        write_mallet(folder, law, scene, encoder_rate, encoder_noise, rng)
    if scene.commands:
        rows = (",".join(f"{value:.6f}" for value in row) for row in scene.commands)
        write(folder / "commands.csv", "t,x_f,y_f,V_x,V_y,t_x1,t_y1,t_x2,t_y2", rows)
    if scene.drive is not None:
        write_drive(folder, law, scene)
    about = meta(law, camera, note or SCENARIOS[scenario])
    if scenario == "drive":
        about["gantry"] = {"pulley_radius_m": law.pulley_radius, "supply_V": SUPPLY}
    (folder / "meta.json").write_text(json.dumps(about, indent=1) + "\n", newline="\n")
    return scene


def write_frames(folder: Path, seen: tuple[np.ndarray, np.ndarray, np.ndarray] | None = None, digits: int = 5) -> None:
    """Write frames.csv from stamps, puck and opponent with `digits` digits of metres; a header alone without them."""
    rows = (
        f"{t:.6f},{cell(x, digits)},{cell(y, digits)},{cell(ox, digits)},{cell(oy, digits)}"
        for t, (x, y), (ox, oy) in (zip(*seen, strict=True) if seen is not None else ())
    )
    write(folder / "frames.csv", "t,puck_x,puck_y,opponent_x,opponent_y", rows)


def write_mallet(folder: Path, law: Law, scene: Scene, rate: float, noise: float, rng: np.random.Generator) -> None:
    """Write mallet.csv: the robot's mallet `rate` times a second, and the expected path if there is one."""
    t = np.arange(round((scene.t[-1] + FINE) * rate)) / rate
    t = t[t <= scene.t[-1]]
    paths = [look_up(t, scene.mallets[0]) + noise * rng.standard_normal((len(t), 2))]
    header = "t,mallet_x,mallet_y"
    if scene.expected is not None:
        paths.append(look_up(t, scene.expected))
        header += ",expected_x,expected_y"
    stamps = t * (1.0 + law.encoder_clock)
    rows = (
        f"{time:.6f}," + ",".join(f"{value:.5f}" for value in row)
        for time, row in zip(stamps, np.concatenate(paths, axis=1), strict=True)
    )
    write(folder / "mallet.csv", header, rows)


def write_drive(folder: Path, law: Law, scene: Scene) -> None:
    """Write drive.csv: the two motors' shares of the supply at every LOOP, held until the next."""
    assert scene.drive is not None
    drive = np.array(scene.drive)
    t = np.arange(round((scene.t[-1] + FINE) / LOOP)) * LOOP
    held = drive[np.searchsorted(drive[:, 0], t + 0.5 * LOOP) - 1, 1:]
    left, right = 0.5 * (held[:, 0] - held[:, 1]) / SUPPLY, -0.5 * (held[:, 0] + held[:, 1]) / SUPPLY
    stamps = t * (1.0 + law.encoder_clock)
    rows = (f"{time:.6f},{a:.5f},{b:.5f}" for time, a, b in zip(stamps, left, right, strict=True))
    write(folder / "drive.csv", "t,pwm_left,pwm_right", rows)


def meta(law: Law, camera: Camera, note: str) -> dict[str, object]:
    """The meta data of a recording: sizes and nominal camera data; no law and no concealed effect."""
    return {
        "format": "puckpilot-recording/1",
        "table": {"length_m": law.length, "width_m": law.width, "goal_width_m": law.goal_width},
        "puck": {"radius_m": law.puck_radius},
        "mallet": {"radius_m": law.mallet_radius},
        "camera": {
            "rate_hz": camera.rate,
            **(
                {"position_std_m": None, "place_std_m": camera.place_error}
                if camera.place_error
                else {"position_std_m": camera.noise}
            ),
        },
        "note": note,
    }


def cell(value: float, digits: int) -> str:
    """Format a number; NaN (not seen) is a blank."""
    return "" if np.isnan(value) else f"{value:.{digits}f}"


def write(path: Path, header: str, rows: Iterable[str]) -> None:
    """Write a CSV file of a header and rows."""
    path.write_text("\n".join([header, *rows]) + "\n", newline="\n")
