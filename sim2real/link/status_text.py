"""Texts and figures that describe the board's events and the status of a session."""

from __future__ import annotations

from dataclasses import asdict
from enum import IntEnum
from typing import Any

from sim2real.link.session import Session
from sim2real.link.wire.messages import FORMATS, Event, Fault, Notice, Refusal, State

PLACELESS = (State.BOOT, State.UNHOMED)  # states in which the place in telemetry is meaningless
DRIFT_KNOWN = 100.0  # ppm, greatest error bound of a drift that is reported
_NAMES = {number: kind.__name__.lower() for kind, (number, _) in FORMATS.items()}

_REMEDIES: dict[int, str] = {
    Refusal.OTHER_CONFIG: "; it does not hold the configuration sent last: send that again, then arm"
}


def enum_name(enum: type[IntEnum], number: int) -> str:
    """The name of an enum's value; the number itself if it has none."""
    return enum(number).name if number in list(enum) else str(number)


def event_text(event: Event) -> str:
    """Describe an event in a few words."""
    if event.code == Notice.BOOTED:
        return f"board started (cause {event.detail})"
    if event.code == Notice.STATE:
        return f"board is {enum_name(State, event.detail)}"
    if event.code == Notice.FAULTED:
        return f"board stopped: {enum_name(Fault, event.detail)}"
    if event.code == Notice.REFUSED:
        asked = event.detail >> 8
        why = event.detail & 0xFF
        return (
            f"board refused {_NAMES.get(asked, f'message {asked}')}: {enum_name(Refusal, why)}{_REMEDIES.get(why, '')}"
        )
    return f"event {event.code}, detail {event.detail}"


def status_figures(session: Session) -> dict[str, Any]:
    """The status of a session as a JSON object; None for what the board has not reported."""
    telemetry = session.telemetry
    known = len(session.clock) > 0
    return {
        "connected": session.connected,
        "state": enum_name(State, telemetry.state) if telemetry else None,
        "fault": enum_name(Fault, telemetry.fault) if telemetry else None,
        "telemetry": asdict(telemetry) if telemetry else None,
        "age_s": session.age,
        "telemetry_hz": session.telemetry_status.rate,
        "missing": session.telemetry_status.missing,
        "pings": {"sent": session.pings.sent, "answered": session.pings.answered, "lost": session.pings.lost},
        "frames": asdict(session.frame_counts),
        "echoes": session.echoes,
        "resets": session.resets,
        "reconnects": session.reconnects,
        "clock_error_us": 1e6 * session.clock.error_s() if known else None,
        "drift_ppm": 1e6 * session.clock.drift if known else None,
        "drift_error_ppm": 1e6 * session.clock.drift_error if known else None,
    }


def drift_text(drift: float, error: float) -> str:
    """Describe the drift of the board's clock with its error bound, both in ppm."""
    if error > DRIFT_KNOWN:
        return "drift not known yet"
    return f"{abs(drift):.1f} ppm {'fast' if drift >= 0.0 else 'slow'} (to {error:.0f} ppm)"


def status_line(session: Session) -> str:
    """The most important status figures in one line."""
    if not session.port_is_open:
        return "no port"
    telemetry, silent = session.telemetry, "" if session.connected else "no answer to hello; "
    if telemetry is None:
        return f"{silent}no telemetry"
    now = status_figures(session)
    fault = "" if telemetry.fault == Fault.NONE else f" {now['fault']}"
    clock = (
        "?"
        if now["clock_error_us"] is None
        else f"{now['clock_error_us']:.0f} us, {drift_text(now['drift_ppm'], now['drift_error_ppm'])}"
    )
    at = "unknown" if telemetry.state in PLACELESS else "{:.4f} {:.4f} m".format(*telemetry.place)
    path_x, path_y = telemetry.path
    return (
        f"{silent}{now['state']}{fault}  place {at}  path {path_x:.4f} {path_y:.4f} m  "
        f"pwm {telemetry.pwm[0]:+d} {telemetry.pwm[1]:+d}  angle {telemetry.angle[0]} {telemetry.angle[1]}  "
        f"traj {telemetry.sequence}  age {1e3 * now['age_s']:.0f} ms  missing {now['missing']}  "
        f"damaged here {session.frame_counts.refused} there {telemetry.damaged}  lost {telemetry.lost}  "
        f"tick {telemetry.longest} us  clock within {clock}"
    )
