"""All parts of the loop's delay, of a measurement or of an ordinary recording."""

from __future__ import annotations

import numpy as np

from sim2real.recording.folder import Recording
from sim2real.table.latency.camera import DELAY, DRIFT, PPM, RING, by_contacts, by_ring, has_ring, shift_of_ring
from sim2real.table.latency.gantry import command_delay, following
from sim2real.table.latency.measure import Echo, Measurement
from sim2real.table.latency.part import Kind, Part
from sim2real.table.latency.path_shift import NotDeterminedError, PathShift
from sim2real.table.mallet_driver import AHEAD

ECHO = "pings and their echoes"
STAMP = Kind("stamp", "the frame's stamp to its places' use", "when frames came")
FRAME = Kind("frame", "exposure to its places' use", "both of the above")
LINE = Kind("line", "one way of the line", ECHO)
CLOCK = Kind("board_clock", "the board's clock on the host's", ECHO)
BOARD_DRIFT = Kind("board_drift", "gain of the board's clock", ECHO, "ppm")
PLAN = Kind("plan", "a plan is sent until it acts", "the loop's own number")
TOTAL = Kind("total", "exposure to the mallet's motion", "frame, plan, follow")


def parts_of_measurement(measured: Measurement) -> list[Part]:
    """The parts by camera, echo and encoders."""
    recording, echo = measured.recording, measured.echo
    assert recording.frames is not None
    stamps = recording.frames.t
    behind = measured.arrived - stamps[:, None]
    stamp = STAMP.between(float(behind.mean()), *(float(one) for one in behind.mean(axis=0)))
    try:
        shift = shift_of_ring(recording, float(np.median(-behind)))
        camera = by_ring(shift, echo.clock_error, echo.drift_error)
        frame = _frame(shift, echo.clock_error, stamps, measured.arrived)
    except NotDeterminedError as why:
        kinds = Kind(*DELAY, RING), Kind(*DRIFT, RING, "ppm"), FRAME
        *camera, frame = (kind.unknown(str(why)) for kind in kinds)
    plan, follow = PLAN.found(AHEAD, 0.0), following(recording)
    gantry = [command_delay(recording), follow]
    return [*camera, stamp, frame, *_by_echo(echo), plan, *gantry, _total([frame, plan, follow])]


def parts_of_recording(recording: Recording) -> list[Part]:
    """The parts that a recording determines; the others say why not."""
    if has_ring(recording):
        try:
            camera = by_ring(shift_of_ring(recording))
        except NotDeterminedError as why:
            camera = [Kind(*DELAY, RING).unknown(str(why)), Kind(*DRIFT, RING, "ppm").unknown(str(why))]
    else:
        camera = by_contacts(recording)
    silent = "a recording does not say when frames came"
    follow = following(recording)
    unheard = "a recording holds no pings"
    rest = [STAMP.unknown(silent), FRAME.unknown(silent), LINE.unknown(unheard)]
    return [*camera, *rest, command_delay(recording), follow, TOTAL.unknown(silent)]


def _frame(shift: PathShift, clock_error: float, stamps: np.ndarray, arrived: np.ndarray) -> Part:
    """From exposure until a frame's places were there: it was not yet when the host looked before."""
    exposed = stamps - shift.delay - shift.rate * (stamps - shift.middle)
    low, high = (float(one) for one in (arrived - exposed[:, None]).mean(axis=0))
    half = shift.delay_half + clock_error
    return FRAME.between(0.5 * (low + high), low - half, high + half)


def _by_echo(echo: Echo) -> list[Part]:
    """How a round trip splits into its two ways is not seen: either may be nothing, and the other all."""
    least = float(echo.round_trips.min())
    return [
        LINE.between(0.5 * least, 0.0, least),
        CLOCK.found(0.0, echo.clock_error),
        BOARD_DRIFT.found(PPM * echo.drift, PPM * echo.drift_error),
    ]


def _total(of: list[Part]) -> Part:
    """The sum of parts one after the other; their intervals are added, because they share the clocks' errors."""
    missing = [one.name for one in of if not one.determined]
    if missing:
        return TOTAL.unknown(f"it takes {', '.join(missing)}")
    value, low, high = (sum(getattr(one, name) for one in of) for name in ("value", "low", "high"))
    return TOTAL.between(value, low, high)
