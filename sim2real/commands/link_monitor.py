"""Monitor the line to the microcontroller: print the board's status twice a second, and every event.

Ctrl-C ends it. This command neither arms nor configures the board; if it is armed, it disarms it.
"""

from __future__ import annotations

import argparse
import json
import time

from sim2real.link.arguments import add_port, session_of

EVERY = 0.5  # s between status lines


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    add_port(parser)
    parser.add_argument("--seconds", type=float, metavar="S", help="end after S seconds (until Ctrl-C)")
    parser.add_argument("--json", action="store_true", help="print JSON, an object a line")


def run(args: argparse.Namespace) -> int:
    """Monitor until the time is over or Ctrl-C. Returns 0; raises ValueError, in one line, if there is no board."""
    from sim2real.link.link_quality import wait_for_board
    from sim2real.link.status_text import event_text, status_figures, status_line

    if args.seconds is not None and not 0.0 < args.seconds <= 1e6:
        raise ValueError(f"--seconds is {args.seconds:g}; expected a number above 0, at most 1e6")
    with session_of(args) as session:
        begin = time.perf_counter()
        due = begin + EVERY
        try:
            wait_for_board(session)
            while args.seconds is None or time.perf_counter() < begin + args.seconds:
                session.poll()
                if not session.port_is_open:
                    time.sleep(0.01)
                now = time.perf_counter()
                for words in [*session.take_notes(), *map(event_text, session.take_events())]:
                    _print(now - begin, words, {"note": words}, args.json)
                session.take_telemetry()
                if now >= due:
                    due = max(due + EVERY, now)
                    _print(now - begin, status_line(session), status_figures(session), args.json)
        except KeyboardInterrupt as stop:
            if stop.args:  # terminated from outside
                raise
        return 0


def _print(seconds: float, words: str, found: dict, as_json: bool) -> None:
    text = (
        json.dumps({"time_s": round(seconds, 3), **found}, allow_nan=False) if as_json else f"{seconds:8.2f} s  {words}"
    )
    print(text, flush=True)
