"""Delays and clock errors that are put into a twin, by name, and what a measurement should find of them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from sim2real.table.latency.camera import PPM
from sim2real.table.twin.board import BoardErrors
from sim2real.table.twin.camera import CameraErrors
from sim2real.table.twin.twin import law_of

# name -> (least, greatest, unit)
LIMITS = {
    "camera": (0.0, 0.06, "s, by which frames are stamped late"),
    "drift": (-200.0, 200.0, "ppm, by which the camera's clock gains"),
    "frame": (0.0, 0.045, "s, from the stamp until places can be used"),
    "line": (0.0, 0.06, "s, of the line to the board, either way"),
    "crystal": (-200.0, 200.0, "ppm, by which the board's clock gains"),
    "gantry": (0.0, 0.008, "s, by which volts reach the motors late"),
}


def read_injection(words: Sequence[str]) -> dict[str, float]:
    """Numbers by name of words NAME=VALUE. ValueError, in one line, for an unknown name or a number out of range."""
    found: dict[str, float] = {}
    for word in words:
        name, given, text = word.partition("=")
        if name not in LIMITS or not given:
            raise ValueError(f"--inject {word}: no such delay; expected NAME=VALUE with NAME of {', '.join(LIMITS)}")
        if name in found:
            raise ValueError(f"--inject {word}: {name} is given twice; leave one out")
        low, high, unit = LIMITS[name]
        try:
            found[name] = float(text)
        except ValueError:
            found[name] = np.nan
        if not low <= found[name] <= high:
            raise ValueError(f"--inject {word}: expected a number from {low:g} to {high:g} {unit}")
    return found


def twin_options(injected: Mapping[str, float], p: np.void) -> dict[str, Any]:
    """Options of the twin with these errors; p: the game's parameters."""
    late = injected.get("camera", 0.0)
    frame = injected.get("frame", CameraErrors.delay)
    camera = CameraErrors(delay=late + frame, stamp_late=late, drift=injected.get("drift", 0.0) / PPM)
    board = BoardErrors(injected.get("crystal", 0.0) / PPM, injected.get("line", 0.0))
    return {
        "errors": camera,
        "board_errors": board,
        "law": replace(law_of(p), command_delay=injected.get("gantry", 0.0)),
    }


def truth(injected: Mapping[str, float], middle: float) -> dict[str, float]:
    """What is true of the parts, by their names, at the time `middle` of the camera's stamps [s].

    `line` is what was put in: bytes take their own time besides.
    """
    drift = injected.get("drift", 0.0) / PPM
    late = injected.get("camera", 0.0)
    return {
        "camera": (drift * middle + late) / (1.0 + drift),
        "camera_drift": PPM * drift,
        "frame": late + injected.get("frame", CameraErrors.delay),
        "line": injected.get("line", 0.0),
        "board_drift": injected.get("crystal", 0.0),
        "command": injected.get("gantry", 0.0),
    }
