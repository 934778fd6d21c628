"""The robot's board at the end of a line: greeted, configured, homed, armed; plans go to it, telemetry comes back."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from puckpilot_env.game import mirror
from puckpilot_env.physics.gantry.mallet import axis_coefficients
from sim2real.link.serial_port import SerialLine
from sim2real.link.session import Session
from sim2real.link.wire.messages import FORMATS, Config, Event, Fault, Notice, Refusal, State, Traj
from sim2real.table.backend import Place, TableFaultError
from sim2real.table.mallet_driver import MalletPlan, operating_volts

PROPORTIONAL, INTEGRAL, DERIVATIVE = 400.0, 500.0, 2.0  # V/m, V/m/s, V s/m of both axes
OFF_PATH = 0.05  # m from its path at which the board stops the mallet
SILENCE = 50  # ms without a message after which the board stops
AREA_SLACK = 0.002  # m beyond the area of plans in which the mallet may err before the board stops it
AT_HOME = 0.002  # m from the home that was sent, by the encoders
PATIENCE = 2.0  # s that a step of the bring-up may take
EXCHANGES = 10  # pings that are answered before the board's clock is relied on
POLL = 0.001  # s between polls
STALE = 0.05  # s without telemetry after which the board counts as lost
MICRO = 1e-6


def board_config(p: np.void) -> Config:
    """The configuration for a table of these parameters."""
    x_low, x_high, y_low, y_high = mirror.area(0, p)
    (c5x, c6x, c7x), (c5y, c6y, c7y) = axis_coefficients(p, 0), axis_coefficients(p, 1)
    return Config(
        (c5x, c5y), (c6x, c6y), (c7x, c7y), float(p["pulley_radius"]), float(p["max_voltage"]), operating_volts(p),
        (x_low - AREA_SLACK, x_high + AREA_SLACK), (y_low - AREA_SLACK, y_high + AREA_SLACK),
        (PROPORTIONAL, PROPORTIONAL), (INTEGRAL, INTEGRAL), (DERIVATIVE, DERIVATIVE), OFF_PATH, SILENCE,
    )  # fmt: skip


class BoardLine:
    """A session with the board, served by `serve`, which lets time pass until a moment of the host's clock.

    connect: opens the line; now: the host's clock [s]; serve: lets time pass until a time [s], at most a few
    milliseconds away.
    """

    def __init__(
        self, connect: Callable[[], SerialLine], now: Callable[[], float], serve: Callable[[float], None]
    ) -> None:
        self._connect, self._now, self._serve = connect, now, serve
        self._session: Session | None = None
        self._armed = False
        self._refused = ""  # the first message that the board refused, and why
        self._off_path = 0.0  # m, the farthest since it was taken

    def bring_up(self, config: Config, home: Place) -> None:
        """Greet the board, configure it, home the mallet at `home` [m] and arm. TableFaultError where a step fails."""
        self._session = session = Session(self._connect, self._now)
        self._until(lambda: session.connected and len(session.clock) >= EXCHANGES, "no board answers on this line")
        if session.state == State.FAULT:
            session.clear()
            self._until(lambda: session.state in (State.UNHOMED, State.IDLE), "the board does not leave FAULT")
        session.config(config)
        self._until(lambda: session.state in (State.UNHOMED, State.IDLE), "the board does not get ready")
        session.home(*home)
        self._until(lambda: session.state == State.IDLE and self._stands_at(home), "the board does not take the home")
        session.arm()
        self._until(lambda: session.state == State.ARMED, "the board does not arm")
        self._armed = True

    def _stands_at(self, home: Place) -> bool:
        telemetry = self._open().telemetry
        return telemetry is not None and float(np.hypot(*np.subtract(telemetry.place, home))) < AT_HOME

    def _until(self, done: Callable[[], bool], otherwise: str) -> None:
        end = self._now() + PATIENCE
        while not done():
            if self._now() > end:
                raise TableFaultError(f"{otherwise}; see puckpilot link test")
            self._serve(self._now() + POLL)
            self.poll()
            self._refuse_refusals()

    def poll(self) -> None:
        """Read and answer what is due, and keep the newest telemetry; call it every few milliseconds."""
        session = self._open()
        session.poll()
        for event in session.take_events():
            self._take(event)
        session.take_notes()
        for telemetry in session.take_telemetry():
            if telemetry.state == State.ARMED and telemetry.sequence:
                self._off_path = max(self._off_path, float(np.hypot(*np.subtract(telemetry.place, telemetry.path))))

    def take_off_path(self) -> float:
        """The farthest that the encoders had the mallet from its path since the last call [m]."""
        farthest, self._off_path = self._off_path, 0.0
        return farthest

    def _take(self, event: Event) -> None:
        if event.code == Notice.REFUSED and not self._refused:
            names = {number: message.__name__.lower() for message, (number, _) in FORMATS.items()}
            self._refused = f"{names.get(event.detail >> 8, 'message')}, {Refusal(event.detail & 0xFF).name}"

    def _refuse_refusals(self) -> None:
        if self._refused:
            raise TableFaultError(f"the board refused a {self._refused}; begin anew")

    def check(self) -> None:
        """TableFaultError, in one line, if an armed board does not play any more, or refused what it was sent."""
        session = self._open()
        if not self._armed:
            return
        if not session.port_is_open:
            raise TableFaultError("the board's port is lost; plug it in and begin anew")
        if (session.age or 0.0) > STALE:
            raise TableFaultError(f"no telemetry for {1e3 * STALE:.0f} ms; check the cable and begin anew")
        if session.state == State.FAULT:
            reason = Fault(session.telemetry.fault).name if session.telemetry else "unknown"
            raise TableFaultError(f"the board stopped the motors: {reason}; clear the table and begin anew")
        if session.state not in (None, State.ARMED):
            raise TableFaultError(f"the board is in {State(session.state).name} and not ARMED; begin anew")
        self._refuse_refusals()

    def send(self, plan: MalletPlan) -> None:
        """Send a plan. TableFaultError if there is no board that could take it."""
        session = self._open()
        self.check()
        t1, t2 = ((round(x / MICRO), round(y / MICRO)) for x, y in (plan.t1, plan.t2))
        rest, slow, fast = ((float(row[0]), float(row[1])) for row in plan.modes)
        begin, life = session.clock.to_board(plan.begin), round(plan.life / MICRO)
        try:
            session.traj(Traj(0, begin, life, plan.volts, t1, t2, rest, slow, fast))
        except ValueError as error:
            raise TableFaultError(str(error)) from None

    def stop(self) -> None:
        """Send an emergency stop, if there is a line; never raises."""
        self._armed = False
        if self._session is not None and self._session.port_is_open:
            self._session.estop()

    def close(self) -> None:
        """Stop and close the line."""
        if self._session is not None:
            self.stop()
            self._session.close()
            self._session = None

    def _open(self) -> Session:
        if self._session is None:
            raise TableFaultError("the table is not connected; call connect() first")
        return self._session
