"""Messages between host and microcontroller.

Written by `python -m firmware.generate` from firmware/protocol.toml; do not edit.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum

VERSION = (1, 1)
SCHEMA = 0x447F05CF
UNCHECKED = 1  # id of the message whose CRC begins at 0; that of the others at SCHEMA


class State(IntEnum):
    """What the board may do."""

    BOOT = 0  # has not yet read its encoders
    UNHOMED = 1  # does not know where the mallet is; motors off
    IDLE = 2  # knows where the mallet is; motors off, once a disarmed mallet is braked
    ARMED = 3  # plays
    FAULT = 4  # stopped until `clear`, after a silent host or outside its area by braking; the first reason is kept


class Fault(IntEnum):
    """Why the board stopped the motors by itself."""

    NONE = 0  # nothing happened
    ESTOP = 1  # the host said stop
    HOST_SILENT = 2  # no valid message for longer than the configuration allows
    ENCODER_PARITY = 3  # an encoder's answers had a wrong parity, several in a row
    ENCODER_ERROR = 4  # an encoder reported an error, several in a row
    ENCODER_STUCK = 5  # an encoder's line stays low or high
    ENCODER_FROZEN = 6  # an encoder's angle does not move though its motor is driven
    ENCODER_JUMP = 7  # an encoder's angle moved farther than a motor can turn
    OFF_PATH = 8  # the mallet is farther from its path than the configuration allows: blocked, swapped or reversed
    OUT_OF_AREA = 9  # the mallet is outside its area
    TICK_OVERRUN = 10  # a control tick was missed, or the clock does not go on as ticks do


class Notice(IntEnum):
    """What an event is."""

    BOOTED = 0  # it started; detail: what reset it, as the board says
    STATE = 1  # its state changed; detail: the new state
    FAULTED = 2  # it stopped; detail: the fault
    REFUSED = 3  # it did not do what a message asked; detail: the reason, and the message's id times 256


class Refusal(IntEnum):
    """Why a message was not obeyed."""

    OUT_OF_RANGE = 0  # a number is outside its limits, or none
    WRONG_VERSION = 1  # no hello of the same version and schema came before
    NO_CONFIG = 2  # no configuration came before
    OTHER_CONFIG = 3  # the configuration held is not the one that is meant: it was lost, or another host's came
    BAD_CONFIG = 4  # the configuration's numbers do not fit each other
    WRONG_STATE = 5  # not in this state
    NO_ENCODERS = 6  # the encoders give no valid angle
    OLD_SEQUENCE = 7  # this trajectory or a newer one came before
    SWITCH_ORDER = 8  # the second switching time is before the first
    TOO_MANY_VOLTS = 9  # a motor would need more than the configuration allows
    LEAVES_AREA = 10  # the path leaves the mallet's area
    OFF_START = 11  # the path does not begin where the mallet is
    TOO_LATE = 12  # the time to apply it is past
    TOO_EARLY = 13  # the time to apply it is too far ahead
    BUSY = 14  # one of its kind that came just before is still being looked at, or the mallet is being braked


@dataclass(frozen=True)
class Hello:
    """Who is there. The board answers a host's with its own."""

    major: int  # of the protocol's version
    minor: int
    schema: int  # hash of this definition
    token: int  # the host's choice; the board answers with the same
    boots: int  # the board's choice at each start; 0 from the host


@dataclass(frozen=True)
class Config:
    """The table and how to control it; taken in every state but ARMED."""

    c5: tuple[float, float]  # V s^3; of axes x, y (report E.1)
    c6: tuple[float, float]  # V s^2
    c7: tuple[float, float]  # V s
    pulley_radius: float  # m
    supply: float  # V; what full PWM gives a motor
    most_volts: float  # V; that a motor ever gets
    x: tuple[float, float]  # m; area of the mallet's centre: low, high
    y: tuple[float, float]  # m
    proportional: tuple[float, float]  # V/m; of axes x, y
    integral: tuple[float, float]  # V/m/s
    derivative: tuple[float, float]  # V s/m
    off_path: float  # m; farther from its path the mallet stops
    silence: int  # ms; longer without a message it brakes and stops
    command_delay: int  # us; from an order of volts until the motors obey


@dataclass(frozen=True)
class Home:
    """The mallet stands here now, at rest (report L.2); in UNHOMED and IDLE."""

    x: float  # m
    y: float  # m


@dataclass(frozen=True)
class Arm:
    """Let the motors play; in IDLE."""

    config: int  # the CRC-32 at the end of the configuration's frame that is meant


@dataclass(frozen=True)
class Disarm:
    """Brake the mallet, then motors off; in ARMED."""


@dataclass(frozen=True)
class Estop:
    """Motors off now, in any state."""


@dataclass(frozen=True)
class Clear:
    """Leave FAULT: to IDLE if the mallet's place is still known, else to UNHOMED."""


@dataclass(frozen=True)
class Traj:
    """A plan: volts until t1, reversed until t2, then none; from the state that the modes say. The newest wins."""

    sequence: int  # greater than of every one before, modulo 2^32
    apply: int  # us; when it begins, by the board's clock; looking at it takes 10 ms
    life: int  # us; after it the motors are off
    volts: tuple[float, float]  # V; of axes x, y, signed
    t1: tuple[int, int]  # us
    t2: tuple[int, int]  # us
    rest: tuple[float, float]  # m; where it would coast to
    slow: tuple[float, float]  # m; mode that fades slowly
    fast: tuple[float, float]  # m; mode that fades fast; under 1e-4 on this gantry


@dataclass(frozen=True)
class Ping:
    """Answered at once with `pong`; keeps the host from being silent."""

    token: int


@dataclass(frozen=True)
class Pong:
    """Answer to `ping`, with the board's clock."""

    token: int
    received: int  # us; when the ping's last byte was read
    sent: int  # us; when this was put together


@dataclass(frozen=True)
class Telemetry:
    """How it stands, every second tick."""

    time: int  # us
    state: int
    fault: int
    place: tuple[float, float]  # m; of the mallet, x and y; 0 where it is not known
    path: tuple[float, float]  # m; where its path has it
    pwm: tuple[int, int]  # of both motors, signed, of PWM_FULL
    angle: tuple[int, int]  # of both encoders as read, of 16384 a turn
    sequence: int  # of the trajectory that is played; 0 for none
    damaged: int  # frames with a wrong CRC or length, modulo 2^16
    lost: int  # bytes lost before they were read, modulo 2^16
    longest: int  # us; longest tick so far


@dataclass(frozen=True)
class Event:
    """Something happened."""

    time: int  # us
    code: int  # of the enum notice
    detail: int


MESSAGES = (
    Hello,
    Config,
    Home,
    Arm,
    Disarm,
    Estop,
    Clear,
    Traj,
    Ping,
    Pong,
    Telemetry,
    Event,
)
FORMATS = {  # of a body, as Python's struct has it
    Hello: (1, "<BBIII"),
    Config: (2, "<2f2f2ffff2f2f2f2f2ffHH"),
    Home: (3, "<ff"),
    Arm: (4, "<I"),
    Disarm: (5, "<"),
    Estop: (6, "<"),
    Clear: (7, "<"),
    Traj: (8, "<III2f2I2I2f2f2f"),
    Ping: (9, "<I"),
    Pong: (10, "<III"),
    Telemetry: (11, "<IBB2f2f2h2HIHHH"),
    Event: (12, "<IBI"),
}
LIMITS = {  # of the fields that have some
    Config: {
        "c5": (1e-09, 0.01),
        "c6": (1e-06, 1.0),
        "c7": (0.0001, 10.0),
        "pulley_radius": (0.005, 0.2),
        "supply": (5.0, 30.0),
        "most_volts": (0.1, 30.0),
        "x": (-5.0, 5.0),
        "y": (-5.0, 5.0),
        "proportional": (0.0, 10000.0),
        "integral": (0.0, 100000.0),
        "derivative": (0.0, 1000.0),
        "off_path": (0.001, 1.0),
        "silence": (10, 1000),
        "command_delay": (0, 10000),
    },
    Home: {
        "x": (-5.0, 5.0),
        "y": (-5.0, 5.0),
    },
    Traj: {
        "life": (1000, 5000000),
        "volts": (-60.0, 60.0),
        "t1": (0, 10000000),
        "t2": (0, 10000000),
        "rest": (-10.0, 10.0),
        "slow": (-10.0, 10.0),
        "fast": (-0.001, 0.001),
    },
}
