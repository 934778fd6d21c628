"""Watch the line to the microcontroller, or test it.

- monitor: what the board says of itself, twice a second, and everything that happens; Ctrl-C ends it.
- test: says hello, sends pings, and tells round trip, clock, telemetry and losses. Ends with 0 if all is good, 1 if
  something is not.

Neither arms the board nor configures it; a board that is found armed is disarmed."""

from __future__ import annotations

import argparse
import json
from typing import TYPE_CHECKING

from sim2real.link import BAUD

if TYPE_CHECKING:
    from sim2real.link.session import Session

EVERY = 0.5  # s from a line of the monitor to the next


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """The arguments of the command."""
    parser.add_argument("action", choices=("monitor", "test"), help="what to do")
    parser.add_argument("port", metavar="PORT", help="the board's serial port, /dev/ttyUSB0 for example")
    parser.add_argument("--baud", type=int, default=BAUD, metavar="N", help=f"the port's speed ({BAUD})")
    parser.add_argument("--seconds", type=float, metavar="S", help="monitor for so long (until Ctrl-C)")
    parser.add_argument("--pings", type=int, default=200, metavar="N", help="pings of a test, 20 a second (200)")
    parser.add_argument("--json", action="store_true", help="print JSON, an object a line")


def run(args: argparse.Namespace) -> int:
    """0: watched, or all is good; 1: tested, and something is not. Raises ValueError, in one line, where it cannot."""
    from sim2real.link.port import Port
    from sim2real.link.session import Session

    if args.seconds is not None and not 0.0 < args.seconds <= 1e6:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 1e6")
    if not 2 <= args.pings <= 1000:
        raise ValueError(f"--pings is {args.pings}; expected a whole number from 2 to 1000")
    if args.baud < 1:
        raise ValueError(f"--baud is {args.baud}; expected a whole number above 0")
    session = Session(lambda: Port(args.port, args.baud))
    try:
        return _test(session, args) if args.action == "test" else _monitor(session, args)
    finally:
        session.close()


def _monitor(session: Session, args: argparse.Namespace) -> int:
    import time

    from sim2real.link.trial import meet
    from sim2real.link.words import event_words, figures, line

    begin = time.perf_counter()
    due = begin + EVERY
    try:
        meet(session)
        while args.seconds is None or time.perf_counter() < begin + args.seconds:
            session.poll()
            if not session.port_is_open:
                time.sleep(0.01)
            now = time.perf_counter()
            for words in [*session.take_notes(), *map(event_words, session.take_events())]:
                _print(now - begin, words, {"note": words}, args.json)
            session.take_telemetry()
            if now >= due:
                due = max(due + EVERY, now)
                _print(now - begin, line(session), figures(session), args.json)
    except KeyboardInterrupt as stop:
        if stop.args:  # told to end from outside
            raise
    return 0


def _print(seconds: float, words: str, found: dict, as_json: bool) -> None:
    text = (
        json.dumps({"time_s": round(seconds, 3), **found}, allow_nan=False) if as_json else f"{seconds:8.2f} s  {words}"
    )
    print(text, flush=True)


def _test(session: Session, args: argparse.Namespace) -> int:
    from rich.console import Console

    from sim2real.link.trial import meet, trial

    with Console(stderr=True).status("greeting the board") as status:
        meet(session)
        status.update(f"{args.pings} pings")
        found = {"port": args.port, **trial(session, args.pings)}
    if args.json:
        print(json.dumps(found, allow_nan=False))
    else:
        print("\n".join(_summary(found)))
    return 1 if found["bad"] else 0


def _summary(found: dict) -> list[str]:
    protocol = ".".join(map(str, found["protocol"]))
    lines = [
        f"{found['port']}: a board of protocol {protocol}",
        f"pings: {found['answered']} answered, {found['lost']} lost",
    ]
    if found["answered"]:
        trip = found["round_trip_ms"]
        lines += [
            f"round trip: median {trip['median']:.2f} ms, 99 % within {trip['p99']:.2f} ms",
            f"board's clock: known within {found['clock_error_us']:.0f} us, goes "
            f"{found['drift_ppm']:+.1f} ppm fast (to {found['drift_error_ppm']:.0f} ppm)",
        ]
    if found["telemetry_hz"] is not None:
        lines += [
            f"telemetry: {found['telemetry_hz']:.0f} a second, {found['missing']} missing",
            f"board: {found['damaged_there']} damaged frames, {found['lost_there']} lost bytes, "
            f"longest tick {found['longest_tick_us']} us",
        ]
    return [*lines, *(f"bad: {line}" for line in found["bad"])] if found["bad"] else [*lines, "all is good"]
