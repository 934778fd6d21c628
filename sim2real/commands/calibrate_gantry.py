"""Calibrate the pulley's radius by the two-point procedure of the report (L.2).

The motors stay off. The user moves the mallet by hand from the right-hand corner to the left-hand one, both at the
robot's end of the table and as seen from there; a jig keeps it at known distances from the walls.
"""

from __future__ import annotations

import argparse
import json
import select
import sys
from pathlib import Path
from typing import TYPE_CHECKING

from sim2real.link.arguments import add_port, session_of

if TYPE_CHECKING:
    from sim2real.link.session import Session
    from sim2real.link.two_points import Pair, ShaftAngles

ALIKE = 0.003  # m, largest difference along x between both corners


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of `calibrate gantry`."""
    add_port(parser)
    parser.add_argument("--width", type=float, metavar="M", help="of the table [m] (the simulator's default)")
    parser.add_argument("--mallet-radius", type=float, metavar="M", help="[m] (the simulator's default)")
    parser.add_argument(
        "--jig", type=float, nargs=2, default=(0.0, 0.0), metavar=("X", "Y"),
        help="of the jig: distance of the mallet's edge from the end wall and the side wall [m] (0 0)",
    )  # fmt: skip
    parser.add_argument("--out", type=Path, default=Path("gantry.toml"), metavar="FILE", help="(default gantry.toml)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """Calibrate and write the file. Returns 0; raises ValueError, in one line, if that is impossible."""
    from puckpilot_env.files.whole_file import check_file, write_text_whole
    from puckpilot_env.parameters import TABLE, checked
    from sim2real.link.link_quality import wait_for_board
    from sim2real.link.two_points import ShaftAngles, solve

    defaults = {row.name: row.default for row in TABLE}
    width = checked("width", defaults["width"] if args.width is None else args.width)
    radius = checked("mallet_radius", defaults["mallet_radius"] if args.mallet_radius is None else args.mallet_radius)
    if not all(0.0 <= gap < 0.5 * width - radius for gap in args.jig):
        raise ValueError(f"--jig is {args.jig[0]:g} {args.jig[1]:g}; expected two distances [m], 0 or more, that leave "
                         f"a way across a table of {width:g} m")  # fmt: skip
    check_file(args.out)
    corner = (radius + args.jig[0], radius + args.jig[1])
    shafts = ShaftAngles()
    with session_of(args) as session:
        wait_for_board(session)
        right = _at(session, shafts, "1. Put the mallet into the right-hand corner, with the jig, and press Enter.")
        left = _at(session, shafts, "2. Slide it, in less than a minute, to the left-hand corner, and press Enter.")
    found = solve(right, left, corner, width)
    if abs(found.sideways) > ALIKE:
        raise ValueError(
            f"the corners differ by {1000 * found.sideways:.1f} mm along x; expected the same position of the jig in "
            f"both, within {1000 * ALIKE:.0f} mm: try again, or check for a slipped belt"
        )
    checked("pulley_radius", found.pulley_radius)
    write_text_whole(args.out, f"pulley_radius = {found.pulley_radius:.6g}  # m\n")
    if args.json:
        result = {
            "pulley_radius": found.pulley_radius,
            "sideways": found.sideways,
            "home": corner,
            "offsets": found.offset,
            "file": str(args.out),
        }
        print(json.dumps(result, indent=1))
        return 0
    print(f"pulley radius {1000 * found.pulley_radius:.3f} mm; the corners differ by "
          f"{1000 * abs(found.sideways):.2f} mm along x")  # fmt: skip
    print(f"wrote {args.out}, for --baseline of `puckpilot diagnose`")
    print(f"for [board] of a table.toml: pulley_radius = {found.pulley_radius:.6g}, "
          f"offsets = [{found.offset[0]:.5f}, {found.offset[1]:.5f}]")  # fmt: skip
    print(f"home of the mallet in the right-hand corner: x {corner[0]:.4f} m, y {corner[1]:.4f} m")
    return 0


def _at(session: Session, shafts: ShaftAngles, words: str) -> Pair:
    """The shafts' angles [rad] when the user presses Enter; telemetry is read until then. Raises ValueError if the port
    disappears, the board is reset, or the input ends."""
    print(words, file=sys.stderr, flush=True)
    resets = session.resets
    while not select.select([sys.stdin], [], [], 0.0)[0]:
        _take_telemetry(session, shafts, resets)
    if not sys.stdin.readline():
        raise ValueError(
            "nobody pressed Enter: this command asks for it at each corner, on a terminal or through a pipe"
        )
    _take_telemetry(session, shafts, resets)
    if shafts.angles is None:
        raise ValueError("the board sends no telemetry; see `puckpilot link test`")
    return shafts.angles


def _take_telemetry(session: Session, shafts: ShaftAngles, resets: int) -> None:
    missing = session.telemetry_status.missing
    session.poll()
    if not session.port_is_open or session.resets > resets:
        raise ValueError(
            "the port disappeared or the board was reset during the motion, so turns were not counted; start again"
        )
    if session.telemetry_status.missing > missing + 20:
        raise ValueError("too much telemetry was lost to count turns; see `puckpilot link test`")
    for telemetry in session.take_telemetry():
        shafts.take(telemetry.angle)
