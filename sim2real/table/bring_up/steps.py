"""The steps of a bring-up, in order: each a function of the rig that returns what it saw, or raises StepError."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np

from sim2real.link.wire.messages import Refusal, State
from sim2real.table.bring_up.rig import Rig, StepError, at_rest
from sim2real.table.mallet_driver import operating_volts

PINGS, ROUND_TRIP, CLOCK = 100, 10e-3, 2e-3  # pings; s of their median; s of the clock's error bound
STOPPED = 0.05 + ROUND_TRIP  # s until a stop is confirmed: by the board's clock it takes 50 ms at most; the line adds
SHORT_MOVE, GENTLE = 0.03, 3.0  # m and V of the first motions
FOLLOWS = 0.005  # m from its path
LOOK = 2.0  # s of frames
RATE_WITHIN = 0.02  # of the stated rate
SEEN, SCATTER = 0.95, 0.5e-3  # share of frames with the puck; m of its places at rest
OLD = 0.03  # s of a frame's age when it comes


def link(rig: Rig) -> str:
    """Answers, round trips and the board's clock."""
    session = rig.line.session
    rig.line.greet()
    before, end = session.pings.answered, rig.table.now() + PINGS * session.pings.period * 2
    while session.pings.answered - before < PINGS and rig.table.now() < end:
        rig.table.pass_time(rig.table.now() + 0.001)
        rig.line.poll()
    answered, trip = session.pings.answered - before, float(np.median(session.pings.round_trips))
    error = session.clock.error_s()
    if answered < 0.98 * PINGS:
        raise StepError(f"{answered} of {PINGS} pings were answered; check cable and adapter (puckpilot link test)")
    if trip > ROUND_TRIP:
        raise StepError(f"a round trip takes {1e3 * trip:.1f} ms; set the adapter's latency timer to 1 ms")
    if error > CLOCK:
        raise StepError(f"the board's clock is known within {1e3 * error:.1f} ms alone; see puckpilot link test")
    return f"round trip {1e3 * trip:.2f} ms, the board's clock within {1e3 * error:.2f} ms"


def encoders(rig: Rig) -> str:
    """Both encoders answer, and stand still while nothing moves."""
    rig.line.configure(rig.table.config)
    session, angles = rig.line.session, []
    end = rig.table.now() + 0.5
    while rig.table.now() < end:
        rig.table.pass_time(rig.table.now() + 0.001)
        session.poll()
        angles += [one.angle for one in session.take_telemetry()]
    if not angles:
        raise StepError("no telemetry comes; see puckpilot link test")
    steps = (np.array(angles) - np.array(angles[0]) + 2**13) % 2**14 - 2**13
    spread = np.ptp(steps, axis=0)
    if spread.max() > 20:
        raise StepError(f"an encoder moves by {spread.max()} steps at rest; check its magnet, cable and shield")
    return f"both answer; they move by {spread.max()} of 16384 steps at rest"


def homing(rig: Rig) -> str:
    """The mallet is put home by hand, and the board takes its place."""
    rig.table.home_by_hand(rig.home)
    x, y = rig.line.place
    off = 1e3 * math.dist(rig.line.place, rig.home)
    return f"the mallet is at ({x:.4f}, {y:.4f}) m by its encoders, {off:.1f} mm from where it was to be put"


def power(rig: Rig) -> str:
    """Motors, belts and encoders belong together: short gentle moves arrive, and follow their paths."""
    rig.table.arm()
    worst = 0.0
    for step in ((SHORT_MOVE, 0.0), (0.0, SHORT_MOVE), (-SHORT_MOVE, -SHORT_MOVE)):
        x, y = rig.line.place
        target = x + step[0], y + step[1]
        seen = rig.move(target, GENTLE)
        worst = max([worst, *(math.dist(one.place, one.path) for one in seen if one.path)])
        missed = math.dist(rig.line.place, target)
        if max(missed, worst) > FOLLOWS:
            raise StepError(
                f"a move of {1e3 * SHORT_MOVE:.0f} mm missed by {1e3 * missed:.0f} mm; is the motors' supply on and as "
                "[board] supply says, and do motors and encoders sit on the right shafts?"
            )
    return f"moves of {1e3 * SHORT_MOVE:.0f} mm at {GENTLE:g} V keep within {1e3 * worst:.1f} mm of their paths"


def limits(rig: Rig) -> str:
    """The board refuses plans that leave the area or ask for too many volts."""
    most = operating_volts(rig.game.p)
    found = rig.refusal((2.0 * most + 4.0, 0.0), 0.001)
    if found != Refusal.TOO_MANY_VOLTS:
        raise StepError(f"a plan of {most + 2:.0f} V for each motor was not refused; flash this puckpilot's firmware")
    found = rig.refusal((most, 0.0), 1.0)
    if found != Refusal.LEAVES_AREA:
        raise StepError("a plan that leaves the mallet's area was not refused; flash this puckpilot's firmware")
    return f"plans of more than {most:g} V, and plans that leave the area, are refused"


def stop(rig: Rig) -> str:
    """A moving mallet is stopped by the host, and can be armed again."""
    x, y = rig.line.place
    rig.driver.stand(x, y, rig.table.now())
    begin = rig.table.now() + rig.table.ahead
    rig.table.send(rig.driver.plan([x + 0.15, y, 2 * GENTLE, 2 * GENTLE], begin))
    rig.table.wait(begin + 0.06)
    rig.table.read()
    asked = rig.table.now()
    rig.table.stop()
    took = rig.table.now() - asked
    if rig.line.session.state == State.ARMED:
        raise StepError("the board is still armed after a stop; switch the motors' supply off, and check the line")
    if took > STOPPED:
        raise StepError(
            f"a stop was confirmed {1e3 * took:.0f} ms after it was asked for, expected {1e3 * STOPPED:.0f} ms or less"
            "; check the cable (puckpilot link test), the motors' supply, and that nothing pushes the mallet"
        )
    rig.table.arm()
    seen = rig.watch(0.2).mallets
    if not at_rest(seen):
        raise StepError("the mallet moves after a stop; check that nothing pushes it")
    return f"stopped, and confirmed {1e3 * took:.0f} ms after it was asked to"


def camera(rig: Rig) -> str:
    """Frames come at the camera's rate, without gaps."""
    times = np.array([frame.time for frame in rig.watch(LOOK).frames])
    if len(times) < 10:
        raise StepError(f"{len(times)} frames came in {LOOK:g} s; check the camera and its cable")
    periods = np.diff(times)
    period = float(np.median(periods))
    gaps = int((periods > 1.5 * period).sum())
    stated = rig.table.frame_rate
    if abs(1.0 / period - stated) > RATE_WITHIN * stated:
        raise StepError(f"{1.0 / period:.1f} frames a second come, {stated:g} are stated; set the camera's rate")
    if gaps > 0.01 * len(times):
        raise StepError(f"{gaps} of {len(times)} frames follow a gap; use a faster port, or load this computer less")
    return f"{1.0 / period:.1f} frames a second, {gaps} gaps in {len(times)}"


def light(rig: Rig) -> str:
    """Pictures are neither too bright nor too dark to show puck and opponent."""
    rig.lay_puck()
    frames = rig.watch(LOOK).frames
    for name in ("puck", "opponent"):
        share = np.mean([getattr(frame, name) is not None for frame in frames]) if frames else 0.0
        if share < SEEN:
            raise StepError(f"the {name} is seen in {100 * share:.0f} % of the frames; check lamp, exposure and film")
    return f"puck and opponent are seen in {100 * SEEN:.0f} % of the frames or more"


def film(rig: Rig) -> str:
    """One puck is seen, where it lies, again and again at the same place."""
    frames = [frame for frame in rig.watch(LOOK).frames if frame.puck is not None]
    if max((frame.pucks for frame in frames), default=0) > 1:
        raise StepError("more than one puck is seen; take away what shines beside it")
    places = np.array([frame.puck for frame in frames]).reshape(-1, 2)
    scatter = float(places.std(axis=0).max()) if len(places) else math.inf
    if scatter > SCATTER:
        raise StepError(f"the puck at rest is seen with a scatter of {1e3 * scatter:.2f} mm; check film and focus")
    return f"the puck at rest scatters by {1e3 * scatter:.3f} mm"


def latency(rig: Rig) -> str:
    """Frames are young enough to play by when they come."""
    ages = []
    for _ in range(100):
        rig.table.wait_for_frame(rig.table.now() + 0.02)
        ages.append(rig.table.read().late_s)
    age = float(np.nanpercentile(ages, 99))
    if not age < OLD:
        raise StepError(f"frames are {1e3 * age:.0f} ms old when they come; see puckpilot latency")
    return f"frames are at most {1e3 * age:.1f} ms old when they come (99 %)"


STEPS: tuple[Callable[[Rig], str], ...] = (
    link, encoders, homing, power, limits, stop, camera, light, film, latency,
)  # fmt: skip
