"""A session with the board: greeting, sign of life, what it says, what it is told; and again after a lost port.

    session = Session(lambda: Port("/dev/ttyUSB0"))
    while True:
        session.poll()
        for event in session.take_events(): ...

`poll` does what is due and returns within milliseconds; call it at least every 10 ms. There are no threads, and no
state but what the board says: after a lost port or a reset `state` is None until the board has told it anew.
"""

from __future__ import annotations

import random
import time
from collections import deque
from collections.abc import Callable
from dataclasses import replace

from sim2real.link import messages
from sim2real.link.board_view import BoardView
from sim2real.link.bodies import Message
from sim2real.link.clock import Clock
from sim2real.link.connection import Connection
from sim2real.link.frames import Receiver, Tally, encode, seal
from sim2real.link.messages import SCHEMA, VERSION, Config, Event, Hello, Notice, Pong, Refusal, State, Telemetry, Traj
from sim2real.link.pings import PERIOD, Pings
from sim2real.link.port import Line
from sim2real.link.stopping import Stopping

HELLO_PERIOD = 0.2  # s between greetings that are not answered
SILENCE = 1.0  # s without an answer to a ping after which the board is greeted anew
KEPT = 5000  # messages that wait for somebody to take them: 10 s of telemetry


class Session:
    """Talks through what `connect` opens, and opens it again when it has vanished.

    `now` is the host's clock [s], which exchanges with the board's are stamped by. Raises what `connect` raises.
    """

    def __init__(self, connect: Callable[[], Line], now: Callable[[], float] = time.perf_counter) -> None:
        self.resets = 0  # of the board, that were noticed
        self.echoes = 0  # messages that only a host sends: the port sends back what it is sent
        self.board: Hello | None = None  # the newest greeting; kept when the port is lost
        self.pings = Pings(now())
        self._now = now
        self._telemetry: deque[Telemetry] = deque(maxlen=KEPT)
        self._events: deque[Event] = deque(maxlen=KEPT)
        self._notes: deque[str] = deque(maxlen=KEPT)
        self._sequence = 0
        self._config: int | None = None  # CRC-32 of the configuration sent last
        self._stopping = Stopping(self._notes.append)
        self._connection = Connection(connect, now, self._notes.append)
        self._begin()

    def _begin(self) -> None:
        """With a port that was just opened."""
        self._receiver, self.view = Receiver(), BoardView()
        self._disarm_owed = True  # who was here before may have left it armed
        self._greet()
        self._connection.send(b"\0")  # ends a frame that was cut off

    def _greet(self) -> None:
        """Begin to say hello until it is answered."""
        self._greeted = False
        self._token = random.getrandbits(32)
        self._hello_at = self._now()

    # What is known

    @property
    def port_is_open(self) -> bool:
        """Whether there is a port."""
        return self._connection.open

    @property
    def connected(self) -> bool:
        """Whether a board of this protocol answers there."""
        return self._connection.open and self._greeted

    @property
    def reconnects(self) -> int:
        """Times that the port was lost and came back."""
        return self._connection.reopened

    @property
    def clock(self) -> Clock:
        """The board's clock."""
        return self.pings.clock

    @property
    def tally(self) -> Tally:
        """Frames that came since the port was opened, by what became of them."""
        return self._receiver.tally

    @property
    def telemetry(self) -> Telemetry | None:
        """The newest since the port was opened; None before any, and without a port."""
        return self.view.newest if self._connection.open else None

    @property
    def state(self) -> int | None:
        """The board's, of the enum State, as of the newest telemetry; None as there."""
        return self.telemetry.state if self.telemetry else None

    @property
    def age(self) -> float | None:
        """How old the newest telemetry is [s]; None as there."""
        return self._now() - self.view.arrived if self.telemetry else None

    def take_telemetry(self) -> list[Telemetry]:
        """All that came since the last call, at most the newest 5000."""
        return _drain(self._telemetry)

    def take_events(self) -> list[Event]:
        """The same of events."""
        return _drain(self._events)

    def take_notes(self) -> list[str]:
        """What happened on this side since the last call, a line each, for a human."""
        return _drain(self._notes)

    # What to tell the board. ValueError where it is not connected, or a number is outside its limits.

    def config(self, config: Config) -> None:
        """The table and how to control it. Pings come at a third of its `silence`, if that is more often."""
        self._tell(config)
        self._config = seal(config)
        self.pings.period = min(PERIOD, config.silence / 3000)

    def home(self, x: float, y: float) -> None:
        """The mallet stands there now, at rest [m]."""
        self._tell(messages.Home(x, y))

    def arm(self) -> None:
        """Let the motors play, by the configuration sent last: a board that holds another refuses with OTHER_CONFIG.

        ValueError before the first telemetry, and before a configuration, too.
        """
        if self.state is None:
            raise ValueError("cannot arm: the board has not yet said how it stands; poll until telemetry comes")
        if self.connected and self._config is None:
            raise ValueError("cannot arm: no configuration was sent; send one first")
        self._disarm_owed = False
        self._tell(messages.Arm(self._config or 0))

    def disarm(self) -> None:
        """Motors off."""
        self._tell(messages.Disarm())

    def estop(self) -> None:
        """Motors off now; sent even to a board that has not answered hello, and by `poll` again until telemetry shows
        FAULT. ValueError without a port."""
        if not self._connection.open:
            raise ValueError("cannot stop the board: its port is lost; it stops by itself when the host is silent")
        self._stopping.begin(self._now())
        self._send_estop()

    def clear(self) -> None:
        """Leave the state FAULT. ValueError while an estop is not yet seen to be heard, too."""
        if self._stopping.wanted:
            raise ValueError("cannot clear: the board has not yet shown that it heard the estop; poll until FAULT")
        self._tell(messages.Clear())

    def traj(self, plan: Traj) -> int:
        """Send a plan, once, under the next sequence number, which is returned; `plan`'s own does not matter."""
        number = self._sequence % (2**32 - 1) + 1  # never 0, which means no trajectory
        self._tell(replace(plan, sequence=number))
        self._sequence = number
        return number

    def close(self) -> None:
        """Let go of the port; the board stops when it has heard nothing for long enough."""
        self._connection.close()

    # What is due

    def poll(self) -> None:
        """Read, greet, ping, reopen. ValueError, after which the port is closed, for a board of another protocol."""
        if self._connection.reopen():
            self._begin()
        data = self._connection.read()
        came = self._now()
        for message in self._receiver.feed(data):
            self._take(message, came)
        if not self._connection.open:
            return
        now = self._now()
        if self._stopping.due(now):
            self._send_estop()
        if self._greeted and now - self.pings.answered_at > SILENCE:
            self._notes.append("the board has fallen silent; greeting it again")
            self._greet()
        if not self._greeted and now >= self._hello_at:
            self._hello_at = now + HELLO_PERIOD
            self._send(Hello(*VERSION, SCHEMA, self._token, 0))
        if (ping := self.pings.due(now)) is not None:
            frame = encode(ping)
            self.pings.went(ping, self._now())
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
        self._stopping.take(telemetry.state)
        if self.view.take(telemetry, came) and self._greeted:
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
            self.pings, self.view = Pings(self._now()), BoardView()
        self.board, self._greeted = hello, True
        self.pings.answered_at = self._now()
        self._notes.append(f"connected to a board of protocol {hello.major}.{hello.minor}")

    def _tell(self, message: Message) -> None:
        """Send to a board that is known to understand."""
        frame = encode(message)
        if not self.connected:
            raise ValueError(f"cannot send {type(message).__name__.lower()}: not connected; poll until `connected`")
        self._connection.send(frame)

    def _send_estop(self) -> None:
        self._connection.send(b"\0")  # whatever was cut off on the line, this is not to be a part of it
        self._send(messages.Estop())

    def _send(self, message: Message) -> None:
        self._connection.send(encode(message))


def _drain(waiting: deque) -> list:
    taken = list(waiting)
    waiting.clear()
    return taken
