"""A session with the board: greeting, keep-alive, its reports, orders to it, and recovery after a lost port.

    session = Session(lambda: SerialPort("/dev/ttyUSB0"))
    while True:
        session.poll()
        for event in session.take_events(): ...

`poll` does what is due and returns within milliseconds; call it at least every 10 ms. There are no threads. The state
is the one that the board reports: after a lost port or a reset `state` is None until new telemetry arrives.
"""

from __future__ import annotations

import random
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from sim2real.link.board_clock import BoardClock
from sim2real.link.connection import Connection
from sim2real.link.estop_repeater import EstopRepeater
from sim2real.link.pings import PERIOD, Pings
from sim2real.link.serial_port import SerialLine
from sim2real.link.telemetry_status import TelemetryStatus
from sim2real.link.wire import messages
from sim2real.link.wire.bodies import Message
from sim2real.link.wire.frames import FrameCounts, Receiver, encode, frame_crc
from sim2real.link.wire.messages import (
    SCHEMA,
    VERSION,
    Config,
    Event,
    Hello,
    Notice,
    Pong,
    Refusal,
    State,
    Telemetry,
    Traj,
)

HELLO_PERIOD = 0.2  # s between unanswered greetings
SILENCE = 1.0  # s without an answer to a ping after which the board is greeted again
KEPT = 5000  # messages kept until they are taken: 10 s of telemetry


class Session:
    """A session through the line that `connect` opens, and opens again after it has vanished.

    now: the host's clock [s], which stamps all messages. The constructor raises what `connect` raises.
    """

    def __init__(self, connect: Callable[[], SerialLine], now: Callable[[], float] = time.perf_counter) -> None:
        self.resets = 0  # number of noticed resets of the board
        self.echoes = 0  # number of received messages that only a host sends: the port echoes
        self.board: Hello | None = None  # the newest greeting; kept when the port is lost
        self.pings = Pings(now())
        self._now = now
        self._telemetry: deque[Telemetry] = deque(maxlen=KEPT)
        self._events: deque[Event] = deque(maxlen=KEPT)
        self._notes: deque[str] = deque(maxlen=KEPT)
        self._sequence = 0
        self._config: int | None = None  # CRC-32 of the configuration sent last
        self._estop_repeater = EstopRepeater(self._notes.append)
        self._connection = Connection(connect, now, self._notes.append)
        self._begin()

    def _begin(self) -> None:
        """Start on a port that was just opened."""
        self._receiver, self.telemetry_status = Receiver(), TelemetryStatus()
        self._disarm_owed = True  # a previous host may have left the board armed
        self._greet()
        self._connection.send(b"\0")  # ends a frame that was cut off

    def _greet(self) -> None:
        """Start sending hello until it is answered."""
        self._greeted = False
        self._token = random.getrandbits(32)
        self._hello_at = self._now()

    # Status

    @property
    def port_is_open(self) -> bool:
        """Whether the port is open."""
        return self._connection.open

    @property
    def connected(self) -> bool:
        """Whether a board of this protocol answers."""
        return self._connection.open and self._greeted

    @property
    def reconnects(self) -> int:
        """The number of times that the port was lost and came back."""
        return self._connection.reopened

    @property
    def clock(self) -> BoardClock:
        """The estimate of the board's clock."""
        return self.pings.clock

    @property
    def frame_counts(self) -> FrameCounts:
        """The frames received since the port was opened, counted by outcome."""
        return self._receiver.counts

    @property
    def telemetry(self) -> Telemetry | None:
        """The newest telemetry since the port was opened; None before the first, and without a port."""
        return self.telemetry_status.newest if self._connection.open else None

    @property
    def state(self) -> int | None:
        """The board's state (enum State) in the newest telemetry; None without any."""
        return self.telemetry.state if self.telemetry else None

    @property
    def age(self) -> float | None:
        """The age of the newest telemetry [s]; None without any."""
        return self._now() - self.telemetry_status.arrived if self.telemetry else None

    def take_telemetry(self) -> list[Telemetry]:
        """Take all telemetry since the last call, at most the newest 5000 messages."""
        return _drain(self._telemetry)

    def take_events(self) -> list[Event]:
        """Take all events since the last call, at most the newest 5000."""
        return _drain(self._events)

    def take_notes(self) -> list[str]:
        """Take the notes for the user since the last call, a line each: what happened on the host's side."""
        return _drain(self._notes)

    # Orders to the board. They raise ValueError if it is not connected, or if a number is outside its limits.

    def config(self, config: Config) -> None:
        """Send the configuration. Pings are sent at a third of its `silence` if that is more often than usual."""
        self._send_connected(config)
        self._config = frame_crc(config)
        self.pings.set_period(min(PERIOD, config.silence / 3000), self._now())

    def home(self, x: float, y: float) -> None:
        """Tell the board that the mallet is at rest at x, y [m]."""
        self._send_connected(messages.Home(x, y))

    def arm(self) -> None:
        """Enable the motors with the configuration sent last; a board that has another one refuses with OTHER_CONFIG.

        Raises ValueError also before the first telemetry and before a configuration was sent.
        """
        if self.state is None:
            raise ValueError("cannot arm: the board has not reported its state yet; poll until telemetry arrives")
        if self.connected and self._config is None:
            raise ValueError("cannot arm: no configuration was sent; send one first")
        self._disarm_owed = False
        self._send_connected(messages.Arm(self._config or 0))

    def disarm(self) -> None:
        """Switch the motors off."""
        self._send_connected(messages.Disarm())

    def estop(self) -> None:
        """Emergency stop: switch the motors off now. It is sent even to a board that has not answered hello, and `poll`
        repeats it until telemetry shows FAULT. Raises ValueError without a port."""
        if not self._connection.open:
            raise ValueError("cannot stop the board: its port is lost; it stops by itself when the host is silent")
        self._estop_repeater.begin(self._now())
        self._send_estop()

    def clear(self) -> None:
        """Leave the state FAULT. Raises ValueError also while an emergency stop is not confirmed."""
        if self._estop_repeater.pending:
            raise ValueError("cannot clear: the board has not yet shown that it heard the estop; poll until FAULT")
        self._send_connected(messages.Clear())

    def traj(self, plan: Traj) -> int:
        """Send a plan once, under the next sequence number, which is returned; the sequence number in `plan` is
        ignored."""
        number = self._sequence % (2**32 - 1) + 1  # never 0, which means no trajectory
        self._send_connected(replace(plan, sequence=number))
        self._sequence = number
        return number

    def close(self) -> None:
        """Close the port; the board stops by itself after a silence."""
        self._connection.close()

    # Polling

    def poll(self) -> None:
        """Read and handle messages, and greet, ping and reopen the port as far as due. Raises ValueError, and closes
        the port, for a board of another protocol."""
        if self._connection.reopen():
            self._begin()
        self.listen()
        self.keep_alive()

    def listen(self) -> None:
        """Read and handle messages, and send no pings: a part of `poll`, with which an armed board stops by itself when
        its patience ends."""
        data = self._connection.read()
        now = self._now()
        if data:
            for message in self._receiver.feed(data):
                self._take(message, now)

    def keep_alive(self) -> None:
        """Greet and ping as far as due, and read nothing: a part of `poll`, for a moment in which all of it would take
        too long."""
        now = self._now()
        if not self._connection.open:
            return
        if self._estop_repeater.due(now):
            self._send_estop()
        if self._greeted and now - self.pings.answered_at > SILENCE:
            self._notes.append("the board has fallen silent; greeting it again")
            self._greet()
        if not self._greeted and now >= self._hello_at:
            self._hello_at = now + HELLO_PERIOD
            self._send(Hello(*VERSION, SCHEMA, self._token, 0))
        if (ping := self.pings.due(now)) is not None:
            frame = encode(ping)
            self.pings.mark_sent(ping, self._now())
            self._connection.send(frame)

    def _take(self, message: Message, came: float) -> None:
        if isinstance(message, Telemetry):
            self._take_telemetry(message, came)
        elif isinstance(message, Pong):
            self.pings.take(message, came)
        elif isinstance(message, Event):
            self._take_event(message)
        elif isinstance(message, Hello):
            self._take_hello(message)
        else:
            self.echoes += 1

    def _take_telemetry(self, telemetry: Telemetry, came: float) -> None:
        self._telemetry.append(telemetry)
        self._estop_repeater.take(telemetry.state)
        if self.telemetry_status.take(telemetry, came) and self._greeted:
            self._greet()
        if self._disarm_owed and self._greeted:
            self._disarm_owed = False
            if telemetry.state == State.ARMED:
                self._notes.append("the board was still armed; disarming it")
                self._send(messages.Disarm())

    def _take_event(self, event: Event) -> None:
        self._events.append(event)
        forgot = event.code == Notice.REFUSED and event.detail & 0xFF == Refusal.WRONG_VERSION
        if self._greeted and (forgot or event.code == Notice.BOOTED):
            self._greet()

    def _take_hello(self, hello: Hello) -> None:
        if hello.token != self._token or self._greeted:
            return
        if hello.major != VERSION[0] or hello.schema != SCHEMA:
            self.close()
            raise ValueError(
                f"the board speaks protocol {hello.major}.{hello.minor}, schema {hello.schema:08x}; this host speaks "
                f"{VERSION[0]}.{VERSION[1]}, schema {SCHEMA:08x}; flash the firmware of this puckpilot"
            )
        if self.board is not None and hello.boots != self.board.boots:
            self.resets += 1
            self._notes.append("the board was reset: it knows neither configuration nor place any more")
            self.pings, self.telemetry_status = Pings(self._now()), TelemetryStatus()
        self.board, self._greeted = hello, True
        self.pings.answered_at = self._now()
        self._notes.append(f"connected to a board of protocol {hello.major}.{hello.minor}")

    def _send_connected(self, message: Message) -> None:
        """Send to a board that has answered hello. Raises ValueError if there is none, or for a number outside its
        limits."""
        frame = encode(message)
        if not self.connected:
            raise ValueError(f"cannot send {type(message).__name__.lower()}: not connected; poll until `connected`")
        self._connection.send(frame)

    def _send_estop(self) -> None:
        self._connection.send(b"\0")  # ends a frame that was cut off on the line, so that this one is read alone
        self._send(messages.Estop())

    def _send(self, message: Message) -> None:
        self._connection.send(encode(message))


def _drain(waiting: deque) -> list:
    """Take all elements out of a queue."""
    taken = list(waiting)
    waiting.clear()
    return taken
