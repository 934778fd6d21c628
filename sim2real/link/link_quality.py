"""Measure the quality of the link with some hundred pings, and list what is wrong with it."""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import asdict
from typing import Any

import numpy as np

from sim2real.link.pings import OVERDUE, PERIOD
from sim2real.link.session import Session
from sim2real.link.status_text import enum_name
from sim2real.link.wire.messages import Fault, State

GREETING = 3.0  # s in which a board must answer hello; some are reset by the opening of their port
MOST_ROUND_TRIP = 10e-3  # s, median: a tenth of a decision period
MOST_CLOCK_ERROR = 5e-3  # s
BAD_CRYSTAL = 150e-6  # rate error beyond any crystal's


def wait_for_board(session: Session, now: Callable[[], float] = time.perf_counter) -> None:
    """Poll until the board has answered hello. Raises ValueError, in one line, if it does not."""
    end = now() + GREETING
    while not session.connected:
        if now() > end:
            heard = session.frame_counts.good + session.frame_counts.refused
            what = f"{heard} frames came, {session.frame_counts.good} of them whole" if heard else "no frame came"
            raise ValueError(
                f"no answer to hello in {GREETING:g} s ({what}); is this the board's port, at its baud rate?"
            )
        session.poll()


def measure_link(session: Session, pings: int, now: Callable[[], float] = time.perf_counter) -> dict[str, Any]:
    """Send `pings` pings to a connected board. Returns the measurements as a JSON object, with the faults found in
    "bad". Raises ValueError if the port vanishes."""
    first_answered, before = session.pings.answered, asdict(session.frame_counts)
    at_first, resets = session.telemetry, session.resets
    end = now() + pings * PERIOD * 1.5 + OVERDUE
    while session.pings.answered - first_answered < pings and now() < end:
        session.poll()
        at_first = at_first or session.telemetry
        if not session.port_is_open:
            raise ValueError(f"the port vanished in the middle of the test ({session.take_notes()[-1]})")
    answered = session.pings.answered - first_answered
    trips = np.array(list(session.pings.round_trips)[-answered:] if answered else [np.nan])
    last = session.telemetry
    found: dict[str, Any] = {
        "protocol": [session.board.major, session.board.minor] if session.board else None,
        "pings": pings,
        "answered": answered,
        "lost": session.pings.lost,
        "round_trip_ms": {"median": _ms(np.median(trips)), "p99": _ms(np.percentile(trips, 99))},
        "clock_error_us": 1e6 * session.clock.error_s() if answered else None,
        "drift_ppm": 1e6 * session.clock.drift if answered else None,
        "drift_error_ppm": 1e6 * session.clock.drift_error if answered else None,
        "clock_jumps": session.clock.jumps,
        "telemetry_hz": session.telemetry_status.rate,
        "missing": session.telemetry_status.missing,
        "refused": {k: v - before[k] for k, v in asdict(session.frame_counts).items() if k != "good" and v > before[k]},
        "damaged_there": (last.damaged - at_first.damaged) % 2**16 if last and at_first else None,
        "lost_there": (last.lost - at_first.lost) % 2**16 if last and at_first else None,
        "longest_tick_us": last.longest if last else None,
        "state": enum_name(State, last.state) if last else None,
        "fault": enum_name(Fault, last.fault) if last else None,
        "resets": session.resets - resets,
        "echoes": session.echoes,
    }
    return {**found, "bad": faults_found(found)}


def _ms(seconds: float) -> float | None:
    """Milliseconds for JSON; None for NaN."""
    return None if np.isnan(seconds) else 1e3 * float(seconds)


def faults_found(found: dict[str, Any]) -> list[str]:
    """The faults that measurements show, a line each with its remedy."""
    trip, error, drift = found["round_trip_ms"]["median"], found["clock_error_us"], found["drift_ppm"]
    checks = [
        (found["lost"] > 0 or found["answered"] == 0, f"{found['lost']} pings were never answered: check the cable"),
        (bool(found["refused"]), f"damaged frames from the board {found['refused']}: check cable and baud rate"),
        (bool(found["damaged_there"]), f"{found['damaged_there']} damaged frames at the board: check cable and ground"),
        (bool(found["lost_there"]), f"the board lost {found['lost_there']} bytes: it is too busy to read"),
        (
            found["state"] == enum_name(State, State.FAULT),
            f"the board is in FAULT ({found['fault']}) and moves nothing: mend the cause, then reset it",
        ),
        (found["telemetry_hz"] is None, "no telemetry came: the board may be stuck"),
        (found["missing"] > 0, f"{found['missing']} telemetry messages did not come: this computer may be too busy"),
        (found["resets"] > 0, f"the board was reset {found['resets']} times: check its supply"),
        (found["echoes"] > 0, f"{found['echoes']} messages came back as they were sent: are the lines crossed?"),
        (found["clock_jumps"] > 0, f"the board's clock jumped {found['clock_jumps']} times"),
        (
            trip is not None and trip > 1e3 * MOST_ROUND_TRIP,
            f"the round trip takes {trip or 0:.1f} ms: set the adapter's latency timer to 1 ms",
        ),
        (
            error is not None and error > 1e6 * MOST_CLOCK_ERROR,
            f"the board's clock is known to {1e-3 * (error or 0):.1f} ms only: see the round trip",
        ),
        (
            drift is not None and abs(drift) - found["drift_error_ppm"] > 1e6 * BAD_CRYSTAL,
            f"the board's clock goes wrong by {drift or 0:.0f} ppm: does it run from its crystal?",
        ),
    ]
    return [line for wrong, line in checks if wrong]
