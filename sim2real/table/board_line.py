"""The robot's board at the end of a line: greeted, configured, homed, armed; plans go to it, telemetry comes back."""

from __future__ import annotations

import math
import warnings
from collections.abc import Callable
from contextlib import suppress
from dataclasses import replace

import numpy as np

from firmware import PWM_FULL
from sim2real.link.serial_port import SerialLine
from sim2real.link.session import Session
from sim2real.link.wire.messages import FORMATS, Config, Event, Fault, Notice, Refusal, State, Telemetry, Traj
from sim2real.table.backend import Place, SeenMallet
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.mallet_driver import MalletPlan
from sim2real.table.plan_fates import PlanFates

AT_HOME = 0.002  # m from the home that was sent, by the encoders
PATIENCE = 2.0  # s that a step of the bring-up may take
BRAKES_WITHIN = 0.1  # s in which a board that was asked to shows that it has stopped, before it gets an emergency stop
ESTOP_WITHIN = 0.05  # s in which it shows that it did that, before a person is warned
EXCHANGES = 10  # pings that are answered before the board's clock is relied on
POLL = 0.0009  # s between polls; no whole number of the board's ticks, so that pings meet these at all phases
SHOWN_WITHIN = 0.01  # s in which telemetry shows what a message did
LAPSED = 0.8  # s without an answer, after which what is known of a session is not believed: it ends 0.2 s later
STALE = 0.03  # s without telemetry, which comes every 2 ms, after which the board counts as lost
MICRO = 1e-6
HARMLESS = ("disarm", "clear")  # refused where the board is not in the state that they end
NAMES = {number: message.__name__.lower() for message, (number, _) in FORMATS.items()}


class BoardLine:
    """A session with the board, served by `serve`, which lets time pass until a moment of the host's clock.

    connect: opens the line; now: the host's clock [s]; serve: lets time pass until a time [s], at most a few
    milliseconds away.
    """

    def __init__(
        self, connect: Callable[[], SerialLine], now: Callable[[], float], serve: Callable[[float], None]
    ) -> None:
        self._now, self._serve = now, serve
        self.session = Session(connect, now)
        self._armed = False
        self._resets = 0  # of the board, when it was armed last
        self._heard = -math.inf  # when telemetry came last [s]
        self._clears_at = -math.inf  # when a board in FAULT is asked to leave it next
        self._refused = ""  # the first message that the board refused, and why
        self._fates = PlanFates()
        self._said: list[SeenMallet] = []  # since they were taken, by the clock of the board that said so

    # Bring-up, step by step

    def greet(self) -> None:
        """Greet the board, until it answers and its clock is known, and have it leave FAULT. TableFaultError if it does
        not."""
        session, begun = self.session, self._now()
        since = begun if begun - session.pings.answered_at > LAPSED else -math.inf
        self._refused, self._fates = "", PlanFates()
        self._await(
            lambda: session.connected and len(session.clock) >= EXCHANGES and session.pings.answered_at > since,
            "no board answers on this line",
        )
        self._await(
            lambda: session.state is not None and session.telemetry_status.arrived > begun,
            "the board sends no telemetry",
        )
        self._refused = ""  # of what was sent before
        if session.state != State.ARMED:  # one that is still armed has just been disarmed
            self._until(lambda: not self._driving, "the board does not switch the motors off")
        if session.state == State.FAULT:
            self._until(self._cleared, "the board does not leave FAULT")

    @property
    def _driving(self) -> bool:
        """Whether a motor is driven, as to brake after a stop, by the newest telemetry."""
        telemetry = self.session.telemetry
        return telemetry is not None and any(telemetry.pwm)

    def _cleared(self) -> bool:
        if self.session.state == State.FAULT:
            if self._now() >= self._clears_at:
                with suppress(ValueError):  # while a stop is not confirmed
                    self.session.clear()
                self._clears_at = self._now() + SHOWN_WITHIN
            return False
        return self.session.state in (State.UNHOMED, State.IDLE)

    def configure(self, config: Config) -> None:
        """Send the configuration. TableFaultError if the board refuses it, or is armed."""
        self._order(self.session.config, config)
        self._until(lambda: self.session.state in (State.UNHOMED, State.IDLE), "the board does not get ready")

    @property
    def homed(self) -> bool:
        """Whether the board knows where its mallet is."""
        return self.session.state in (State.IDLE, State.ARMED)

    @property
    def place(self) -> Place:
        """The mallet's place by its encoders [m]. TableFaultError before it is known."""
        telemetry = self.session.telemetry
        if telemetry is None or not self.homed:
            raise TableFaultError(Cause.NOT_READY, "the board does not know where its mallet is; home it first")
        return telemetry.place

    def home(self, home: Place) -> None:
        """Tell the board that the mallet is at rest at `home` [m]. TableFaultError if it does not take it."""
        self._order(self.session.home, *home)
        self._until(
            lambda: self.homed and math.dist(self.place, home) < AT_HOME, "the board does not take the home"
        )  # fmt: skip

    def arm(self) -> None:
        """Enable the motors. TableFaultError if the board does not."""
        self._armed, self._resets = True, self.session.resets  # from now on it may be
        self._heard = self._now()
        self._order(self.session.arm)
        self._until(lambda: self.session.state in (State.ARMED, State.FAULT), "the board does not arm")
        self.check()

    def _order(self, order: Callable[..., object], *numbers: object) -> None:
        """Give the session an order. TableFaultError where it cannot be sent."""
        try:
            order(*numbers)
        except ValueError as error:
            raise TableFaultError(Cause.NOT_READY, f"{error}; then clear") from None

    def _until(self, done: Callable[[], bool], otherwise: str) -> None:
        """Wait for what follows from a message. TableFaultError if the board refuses it, or PATIENCE ends."""
        self._await(lambda: self._refuse_refusals() or done(), otherwise)

    def _await(self, done: Callable[[], bool], otherwise: str) -> None:
        end = self._now() + PATIENCE
        while not done():
            if self._now() > end:
                raise TableFaultError(Cause.NOT_READY, f"{otherwise}; see puckpilot link test")
            self._serve(self._now() + POLL)
            self.poll()

    # Play

    def poll(self) -> None:
        """Read and answer what is due, and keep what telemetry says of the mallet; call it every few milliseconds."""
        self.session.poll()
        self._take_news()

    def _take_news(self) -> None:
        session = self.session
        for event in session.take_events():
            self._take(event)
        session.take_notes()
        for telemetry in session.take_telemetry():
            self._heard = self._now()
            if telemetry.state in (State.IDLE, State.ARMED) and len(session.clock):
                time = session.clock.to_host(telemetry.time)
                self._said.append(_seen(telemetry, time))
                self._fates.see(telemetry.sequence, time)

    def keep_alive(self) -> None:
        """Let the board know that the host is there, and read nothing: instead of `poll`, where time presses."""
        self.session.keep_alive()

    def take_mallets(self) -> list[SeenMallet]:
        """What telemetry said of the mallet since the last call."""
        said, self._said = self._said, []
        return said

    def take_missed(self) -> int:
        """The number of plans since the last call that came too late to the board, or not at all."""
        return self._fates.take_missed()

    def _take(self, event: Event) -> None:
        if event.code != Notice.REFUSED:
            return
        name, reason = NAMES.get(event.detail >> 8, "message"), Refusal(event.detail & 0xFF)
        if name in HARMLESS or (name == "traj" and not self._armed):  # a plan from before a stop
            return
        if name == "traj" and reason == Refusal.TOO_LATE:
            self._fates.refuse_late()
        elif not self._refused:
            self._refused = f"{name}, {reason.name}"

    def _refuse_refusals(self) -> None:
        if self._refused:
            raise TableFaultError(Cause.PLAN_REFUSED, f"the board refused a {self._refused}; clear, and play on")

    def check(self) -> None:
        """TableFaultError, in one line, if an armed board does not play any more, or refused what it was sent."""
        session = self.session
        if not self._armed:
            return
        if not session.port_is_open:
            raise TableFaultError(Cause.PORT_LOST, "the board's port is lost; plug it in and clear")
        if self._now() - self._heard > STALE:
            raise TableFaultError(
                Cause.BOARD_SILENT, f"no telemetry for {1e3 * STALE:.0f} ms; check the cable and clear"
            )
        if session.state == State.FAULT:
            reason = Fault(session.telemetry.fault).name if session.telemetry else "unknown"
            raise TableFaultError(
                Cause.BOARD_STOPPED, f"the board stopped the motors: {reason}; see to the table and clear"
            )
        if session.state not in (None, State.ARMED):  # None for a moment after a reset
            name = State(session.state).name
            raise TableFaultError(Cause.BOARD_NOT_ARMED, f"the board is in {name} and not ARMED; clear to arm it again")
        if self._refused and self._was_reset:
            raise _reset_error()
        self._refuse_refusals()
        if self._fates.hopeless:
            raise TableFaultError(
                Cause.PLAN_REFUSED, "one plan after the other comes to the board too late, or not at all; check cable "
                "and load, then clear"
            )  # fmt: skip

    @property
    def _was_reset(self) -> bool:
        """Whether the board was reset since it was armed: it is greeted again then."""
        return not self.session.connected or self.session.resets != self._resets

    def send(self, plan: MalletPlan) -> MalletPlan:
        """Send a plan; return it with the numbers that the protocol carries. TableFaultError if there is no board that
        could take it."""
        self.check()
        session = self.session
        t1, t2 = ((round(x / MICRO), round(y / MICRO)) for x, y in (plan.t1, plan.t2))
        rest, slow, fast = ((float(row[0]), float(row[1])) for row in np.asarray(plan.modes, np.float32))
        volts = float(np.float32(plan.volts[0])), float(np.float32(plan.volts[1]))
        try:
            begin = session.clock.to_board(plan.begin)
            number = session.traj(Traj(0, begin, round(plan.life / MICRO), volts, t1, t2, rest, slow, fast))
        except ValueError as error:
            raise _reset_error() if self._was_reset else TableFaultError(Cause.NOT_READY, str(error)) from None
        self._fates.send(number, plan.begin)
        seconds = ((MICRO * first, MICRO * second) for first, second in (t1, t2))
        modes = np.array([rest, slow, fast])
        return replace(plan, volts=volts, t1=next(seconds), t2=next(seconds), modes=modes, tick=begin)

    def stop(self) -> None:
        """Have the board brake and switch the motors off; an emergency stop if it does not show that it did. A board
        that cannot be reached stops by itself. Raises nothing."""
        session, armed, self._armed = self.session, self._armed, False
        if not session.port_is_open:
            return
        if session.state is None:
            if session.resets == self._resets:  # else it brakes by itself, which an emergency stop would end
                session.estop()
            return
        if not armed and session.state != State.ARMED:
            return
        with suppress(ValueError):  # not connected
            session.disarm()
        self._await_stop(BRAKES_WITHIN, session.listen)  # a board that heard no disarm hears nothing, and brakes too
        if session.state == State.ARMED and session.port_is_open:
            session.estop()
            self._await_stop(ESTOP_WITHIN, session.poll)
            if session.state == State.ARMED:
                warnings.warn("the board shows no sign of a stop: cut the motors' supply", stacklevel=2)

    def _await_stop(self, seconds: float, attend: Callable[[], None]) -> None:
        """Attend to the line for so many seconds [s], or until the board has stopped; what goes wrong meanwhile ends
        it."""
        session, end = self.session, self._now() + seconds
        with suppress(Exception):
            while (session.state == State.ARMED or self._driving) and session.port_is_open and self._now() < end:
                self._serve(self._now() + POLL)
                attend()
                self._take_news()

    def close(self) -> None:
        """Stop and close the line, whatever happens meanwhile."""
        try:
            self.stop()
        finally:
            self.session.close()


def _reset_error() -> TableFaultError:
    return TableFaultError(Cause.BOARD_NOT_ARMED, "the board was reset; clear to arm it again")


def _seen(telemetry: Telemetry, time: float) -> SeenMallet:
    path = telemetry.path if telemetry.state == State.ARMED and telemetry.sequence else None
    left, right = telemetry.pwm
    return SeenMallet(time, telemetry.place, path, (left / PWM_FULL, right / PWM_FULL), telemetry.time)
