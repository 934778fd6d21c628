"""`table.toml`: all that is particular to one physical table, in one file; EXAMPLE shows what it holds."""

from __future__ import annotations

import math
import sys
from collections.abc import Mapping
from dataclasses import dataclass, field
from os import PathLike
from pathlib import Path
from typing import Any

from puckpilot_env.files.toml_file import check_format, read_toml, refuse_unknown, section
from puckpilot_env.options.inputs import in_short, real_number
from puckpilot_env.options.profile_file import read_profile
from puckpilot_env.parameters import checked
from sim2real.camera.region import RegionOfInterest
from sim2real.camera.settings import CameraSettings
from sim2real.link import BAUD
from sim2real.link.wire.messages import LIMITS, Config
from sim2real.table.board_config import MOST_COMMAND_DELAY, Gains
from sim2real.vision.target_ranges import target_number

FORMAT = "puckpilot-table/1"
EXAMPLE = """\
format = "puckpilot-table/1"

[parameters]                    # sizes and constants by the simulator's names, SI units
length = 2.362
width = 1.144

[camera]
source = "aravis:"              # as of `puckpilot track`
calibration = "table.json"      # of `puckpilot calibrate table`; paths are relative to this file
setup = "setup.png"             # a picture of the whole sensor that shows the markers; or setup_exposure, to take one
region = "1300x1450+396+20"     # of the sensor, that is streamed
pixel_format = "BayerRG8"
exposure = 1e-4                 # s
gain = 25.0                     # dB
rate = 120.0                    # Hz
delay = 0.006                   # s from the middle of the exposure until a frame comes; or [latency] has it
ring_height = 0.05              # m, of the opponent's ring above the table
# film_radius = 0.0309          # m, of the puck's film; left out, it is measured

[board]
port = "/dev/ttyUSB0"
supply = 24.0                   # V
# pulley_radius = 0.0353        # m, once `puckpilot calibrate gantry` has found it
# offsets = [0.51, -1.22]       # rad, of the shafts' encoders, of the same; left out, the home is where the jig is
proportional = [400.0, 400.0]   # V/m, of axes x and y; and so integral [V/m/s], derivative [V s/m]
# command_delay = 0.003         # s by which motors obey late, which is allowed for; or [latency] has it, as `command`

# [gantry]                      # once `puckpilot identify gantry` has made one; until then the simulator's hold
# profile = "gantry.toml"

[latency]                       # the last lines of `puckpilot latency`, as they are; `delay` is the camera's
"""
NUMBERS = ("exposure", "setup_exposure", "gain", "rate")  # of the camera's settings
SETTINGS = (*NUMBERS, "trigger_line", "pixel_format")
TARGETS = {"level": "level", "ring_height": "ring_height", "film_radius": "puck_radius"}  # keys by fields of `Targets`
GAINS = ("proportional", "integral", "derivative")
CAMERA = ("source", "calibration", "setup", "region", "delay", *TARGETS, *SETTINGS)
BOARD = ("port", "baud", "supply", "pulley_radius", "offsets", "command_delay", *GAINS)
LATENCY = ("delay", "camera", "camera_drift", "frame", "line", "command", "follow", "total")  # see `puckpilot latency`
Pair = tuple[float, float]
MOST = sys.float_info.max


@dataclass(frozen=True)
class CameraPart:
    """Where pictures come from and how they are read; see EXAMPLE."""

    source: str
    calibration: Path
    settings: CameraSettings
    setup: Path | None = None
    delay: float = 0.0
    level: float | None = None
    ring_height: float | None = None
    film_radius: float | None = None


@dataclass(frozen=True)
class BoardPart:
    """The board's port and what it is configured with; see EXAMPLE."""

    port: str
    baud: int = BAUD
    offsets: Pair | None = None
    gains: Gains = field(default_factory=Gains)
    command_delay: float = 0.0  # s


@dataclass(frozen=True)
class TableFile:
    """What a table.toml holds. parameters: of the simulator, by name, with those of the gantry's profile."""

    parameters: dict[str, float]
    camera: CameraPart
    board: BoardPart


def read_table_file(path: str | PathLike[str]) -> TableFile:
    """Read a table.toml. Raises ValueError, in one line, for a file that is none."""
    folder = Path(path).absolute().parent
    if Path(path).suffix == ".json":
        raise ValueError(f"{path} is a calibration; expected a table.toml, which names it under [camera]")
    return read_toml(path, "a table", "table.toml (see puckpilot table check --help)", "'port = \"/dev/ttyUSB0\"'",
                     lambda content: _table(content, folder))  # fmt: skip


def _table(content: Mapping[str, Any], folder: Path) -> TableFile:
    check_format(content, FORMAT, ("parameters", "camera", "board", "gantry", "latency"))
    board, gantry = dict(section(content, "board")), section(content, "gantry")
    refuse_unknown(board, BOARD, "key of board")
    refuse_unknown(gantry, ("profile",), "key of gantry")
    given = dict(section(content, "parameters"))
    if "profile" in gantry:
        profile = read_profile(folder / _text(gantry, "profile", "gantry"))
        if profile.of != "gantry":
            raise ValueError(f"gantry.profile is of a {profile.of}; expected one of puckpilot identify gantry")
        given = dict(profile.parameters) | given
    for name, key in (("max_voltage", "supply"), ("pulley_radius", "pulley_radius")):
        if key in board:
            given[name] = board[key]
    parameters = {name: checked(name, value) for name, value in given.items()}
    camera, latency = dict(section(content, "camera")), section(content, "latency")
    refuse_unknown(latency, LATENCY, "key of latency")
    for name in latency:
        if not math.isfinite(real_number(latency[name])):
            raise ValueError(f"latency.{name} is {in_short(latency[name])}; expected a number")
    if "delay" in latency:
        if "delay" in camera:
            raise ValueError("delay is given under [camera] and under [latency]; keep the one that was measured last")
        camera["delay"] = latency["delay"]
    elif latency and "delay" not in camera:
        raise ValueError("[latency] has no delay of the camera; measure it again, or state delay under [camera]")
    if "command" in latency:
        if "command_delay" in board:
            raise ValueError("command_delay is given under [board], and command under [latency]; keep the newer one")
        board["command_delay"] = max(latency["command"], 0.0)
    return TableFile(parameters, _camera(camera, folder), _board(board))


def _camera(camera: Mapping[str, Any], folder: Path) -> CameraPart:
    refuse_unknown(camera, CAMERA, "key of camera")
    given = {name: camera[name] for name in SETTINGS if name in camera}
    given |= {name: _number(camera, name, "camera") for name in NUMBERS if name in camera}
    if "region" in camera:
        given["region"] = RegionOfInterest.parse(_text(camera, "region", "camera"))
    if "setup" in camera and "setup_exposure" in camera:
        raise ValueError(
            "camera.setup and camera.setup_exposure are given; keep one: a picture that is there, or is taken"
        )
    numbers = {"delay": _number(camera, "delay", "camera")} if "delay" in camera else {}
    numbers |= {name: target_number(target, real_number(camera[name]), f"camera.{name}", in_short(camera[name]))
                for name, target in TARGETS.items() if name in camera}  # fmt: skip
    return CameraPart(
        _text(camera, "source", "camera"),
        folder / _text(camera, "calibration", "camera"),
        CameraSettings(**given),
        folder / _text(camera, "setup", "camera") if "setup" in camera else None,
        **numbers,
    )


def _board(board: Mapping[str, Any]) -> BoardPart:
    offsets = _pair(board, "offsets") if "offsets" in board else None
    gains = {name: _pair(board, name, *LIMITS[Config][name]) for name in GAINS if name in board}
    baud = board.get("baud", BAUD)
    if not isinstance(baud, int) or baud < 1:
        raise ValueError(f"board.baud is {in_short(baud)}; expected a whole number above 0")
    late = _number(board, "command_delay", "board", MOST_COMMAND_DELAY) if "command_delay" in board else 0.0
    return BoardPart(_text(board, "port", "board"), baud, offsets, Gains(**gains), late)


def _text(row: Mapping[str, Any], key: str, where: str) -> str:
    if not isinstance(row.get(key), str):
        given = f"is {in_short(row[key])}" if key in row else "is missing"
        raise ValueError(f"{where}.{key} {given}; expected a text, as in puckpilot table check --example")
    return row[key]


def _number(row: Mapping[str, Any], key: str, where: str, most: float = MOST) -> float:
    number = real_number(row[key])
    if not 0.0 <= number <= most:
        span = "0 or more" if most == MOST else f"0 to {most:g}"
        raise ValueError(f"{where}.{key} is {in_short(row[key])}; expected a number, {span}")
    return number


def _pair(row: Mapping[str, Any], key: str, low: float = -MOST, high: float = MOST) -> Pair:
    given = row[key] if isinstance(row[key], list) else []
    numbers = [real_number(one) for one in given]
    if len(numbers) != 2 or not all(low <= one <= high for one in numbers):
        span = "" if high == MOST else f" from {low:g} to {high:g}"
        raise ValueError(f"board.{key} is {in_short(row[key])}; expected two numbers{span}")
    return numbers[0], numbers[1]
