"""Measure the delay of the loop, from a frame's exposure to the mallet's motion, in parts with 95 % intervals.

On a table (`--backend`) the robot's mallet makes strokes of 15 cm about its home, while camera and encoders watch and
pings go to the board and back. Leave the mallet's half of the table free. At a physical table, take the opponent's
mallet off and put its reflective ring on the robot's, or on what carries it, where the camera sees it: height and place
are fitted along. A measurement by a light would take a board that can switch one, and is not made.

Of ordinary recordings it tells what they determine: the camera's delay and drift by contacts of the puck with the
moving mallet (or by the ring, where frames.csv has robot_x and robot_y), the delay from plans or volts to motion, and
how far the mallet is behind its path.

The last lines are a section [latency] for the table's file. Ends with 1 if a recording determines nothing.
"""

from __future__ import annotations

import argparse
import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from sim2real.table.latency.part import Part

SECONDS = (8.0, 600.0)  # s that a measurement may take
OF_A_TABLE = {"backend": "twin", "table": None, "seconds": 20.0, "seed": 0, "inject": []}  # options, by their defaults


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("recordings", metavar="RECORDING", nargs="*", type=Path, help="folders; without any, measure")
    parser.add_argument("--backend", metavar="NAME", help="the table to measure (default twin)")
    parser.add_argument("--table", type=Path, metavar="FILE", help="the table.toml of a physical table")
    parser.add_argument("--seconds", type=float, metavar="S", help="of strokes (default 20)")
    parser.add_argument("--seed", type=int, help="of a twin's noise (default 0)")
    parser.add_argument(
        "--inject",
        nargs="+",
        metavar="NAME=VALUE",
        help="put delays [s] and clock errors [ppm] into a twin: camera, drift, frame, line, crystal, gantry",
    )
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Measure and print. 0: measured; 1: a recording determines nothing. ValueError, in one line, for what cannot be
    measured."""
    if args.recordings:
        return _of_recordings(args)
    for name, default in OF_A_TABLE.items():
        if getattr(args, name) is None:
            setattr(args, name, default)
    return _of_table(args)


def _of_recordings(args: argparse.Namespace) -> int:
    from sim2real.recording.folder import read_recording
    from sim2real.table.latency.parts import parts_of_recording

    if given := next((name for name in OF_A_TABLE if getattr(args, name) is not None), None):
        measured = "twin" if given == "inject" else "table"
        raise ValueError(f"--{given} is given with recordings; it takes a {measured}: leave the recordings out")
    every = {str(path): parts_of_recording(read_recording(path)) for path in args.recordings}
    if args.json:
        shown = {path: {one.name: one.as_dict() for one in parts} for path, parts in every.items()}
        print(json.dumps({"recordings": shown}, indent=2))
    for path, parts in every.items():
        if not args.json:
            print("\n".join([path, *_text(parts)]))
    return 0 if any(one.determined for parts in every.values() for one in parts) else 1


def _of_table(args: argparse.Namespace) -> int:
    from puckpilot_env.options.inputs import seed_number
    from puckpilot_env.variants import find_variant
    from sim2real.table.backends import make_backend, refuse_unknown_backend, stated_parameters
    from sim2real.table.game.game_record import GameRecord
    from sim2real.table.game.loop import home_of
    from sim2real.table.latency.injection import read_injection, truth, twin_options
    from sim2real.table.latency.measure import measure
    from sim2real.table.latency.parts import parts_of_measurement
    from sim2real.table.live_table import LiveTable
    from sim2real.table.physical.table_file import read_table_file

    refuse_unknown_backend(args.backend)
    if not SECONDS[0] <= args.seconds <= SECONDS[1]:
        raise ValueError(f"--seconds is {args.seconds:g}; expected {SECONDS[0]:g} to {SECONDS[1]:g}")
    injected = read_injection(args.inject)
    if injected and args.backend != "twin":
        raise ValueError(f"--inject is given with backend '{args.backend}'; only a twin takes it")
    if (args.table is None) == (args.backend == "table"):
        raise ValueError(
            f"--table is {'missing' if args.table is None else 'given'} with --backend {args.backend}; it states a "
            "physical table: --backend table --table FILE"
        )
    options = {} if args.table is None else {"table": args.table}
    game = GameRecord(find_variant("match-v0"), stated_parameters(args.backend, options))
    if args.backend == "twin":
        options = {"opponent": "still", **twin_options(injected, game.p)}
    with make_backend(args.backend, game, **options) as table:
        if not isinstance(table, LiveTable):
            raise ValueError(f"backend '{args.backend}' has no board and no camera; expected a live table, e.g. twin")
        table.seed(seed_number(args.seed))
        measured = measure(table, game.p, home_of(game.p), args.seconds)
    parts = parts_of_measurement(measured)
    stamps = measured.recording.streams()["frames"].t
    true = truth(injected, 0.5 * float(stamps[0] + stamps[-1])) if args.backend == "twin" else {}
    if args.json:
        print(json.dumps(_result(args, injected, true, parts), indent=2))
    else:
        stated = read_table_file(args.table).camera.delay if args.table else 0.0
        print("\n".join(_text(parts, true if injected else None, stated)))
    return 0


def _result(args: argparse.Namespace, injected: dict, true: dict, parts: Sequence[Part]) -> dict[str, Any]:
    found = {one.name: one.as_dict() for one in parts}
    for one in parts:
        if one.name in true:
            known = (
                {"injected": true[one.name], "off": abs(one.value - true[one.name])} if one.value is not None else {}
            )
            found[one.name] |= known
    return {"backend": args.backend, "seconds": args.seconds, "seed": args.seed, "inject": injected, "parts": found}


def _text(parts: Sequence[Part], true: Mapping[str, float] | None = None, stated: float | None = None) -> list[str]:
    from sim2real.table.latency.table_text import table_lines, toml_lines

    return [*table_lines(parts, true), "", *toml_lines(parts, stated)]
