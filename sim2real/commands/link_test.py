"""Test the line to the microcontroller: send hello and pings, and report round trip, clock, telemetry and losses.

Ends with 0 if everything is good, with 1 if something is not. This command neither arms nor configures the board; if it
is armed, it disarms it.
"""

from __future__ import annotations

import argparse
import json

from sim2real.link.arguments import add_port, session_of


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_port(parser)
    parser.add_argument("--pings", type=int, default=200, metavar="N", help="how many, 20 a second (200)")
    parser.add_argument("--json", action="store_true", help="print one JSON object in the end")


def run(args: argparse.Namespace) -> int:
    """Test the line. Returns 0 if everything is good, 1 if something is not; raises ValueError, in one line, if it
    cannot be tested."""
    from rich.console import Console

    from sim2real.link.link_quality import measure_link, wait_for_board

    if not 2 <= args.pings <= 1000:
        raise ValueError(f"--pings is {args.pings}; expected a whole number from 2 to 1000")
    with session_of(args) as session, Console(stderr=True).status("greeting the board") as status:
        wait_for_board(session)
        status.update(f"{args.pings} pings")
        found = {"port": args.port, **measure_link(session, args.pings)}
    if args.json:
        print(json.dumps(found, allow_nan=False))
    else:
        print("\n".join(_summary(found)))
    return 1 if found["bad"] else 0


def _summary(found: dict) -> list[str]:
    from sim2real.link.status_text import drift_text

    protocol = ".".join(map(str, found["protocol"]))
    lines = [
        f"{found['port']}: a board of protocol {protocol}",
        f"pings: {found['answered']} answered, {found['lost']} lost",
    ]
    if found["answered"]:
        trip = found["round_trip_ms"]
        lines += [
            f"round trip: median {trip['median']:.2f} ms, 99 % within {trip['p99']:.2f} ms",
            f"board's clock: known within {found['clock_error_us']:.0f} us, "
            f"{drift_text(found['drift_ppm'], found['drift_error_ppm'])}",
        ]
    if found["telemetry_hz"] is not None:
        lines += [
            f"telemetry: {found['telemetry_hz']:.0f} a second, {found['missing']} missing",
            f"board: {found['damaged_there']} damaged frames, {found['lost_there']} lost bytes, "
            f"longest tick {found['longest_tick_us']} us",
        ]
    return [*lines, *(f"bad: {line}" for line in found["bad"])] if found["bad"] else [*lines, "all tests passed"]
