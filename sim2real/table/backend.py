"""What a table is to the player of the robot's seat: frames and telemetry come from it, plans go to it."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass, field
from types import TracebackType
from typing import ClassVar, Self

import numpy as np

from sim2real.camera.frame_monitor import Trouble
from sim2real.table.mallet_driver import AHEAD, MalletPlan

Place = tuple[float, float]  # m, in the table's frame
Motion = tuple[float, float, float, float]  # x, y [m], vx, vy [m/s]


@dataclass(frozen=True)
class SeenFrame:
    """What the camera measured in one frame: `time` of its exposure on the host's clock [s]; places, None if unseen;
    the number of candidates for the puck; what is wrong with the picture; covariances (2, 2) of the places [m^2], None
    where they are as usual; the place of a ring on the robot's mallet, None if it is unseen or the mallet has none."""

    time: float
    puck: Place | None
    opponent: Place | None
    pucks: int = 1
    troubles: tuple[Trouble, ...] = ()
    puck_covariance: np.ndarray | None = None
    opponent_covariance: np.ndarray | None = None
    robot: Place | None = None


@dataclass(frozen=True)
class SeenMallet:
    """The robot's mallet by its encoders at `time` on the host's clock [s].

    `path`: where its plan has it, None without one; `duties`: of motors left and right, signed parts of the supply;
    `tick`: the same time on the board's clock, if there is a board [us, u32].
    """

    time: float
    place: Place
    path: Place | None
    duties: tuple[float, float]
    tick: int = 0


@dataclass(frozen=True)
class Reading:
    """All that came since the last reading, in order of time.

    `late_s`: age of the newest frame now [s], nan without frames; `missed`: number of plans that came to the board too
    late, or never, so that those before went on; `over`: nothing will come any more.
    """

    frames: list[SeenFrame] = field(default_factory=list)
    mallets: list[SeenMallet] = field(default_factory=list)
    late_s: float = math.nan
    missed: int = 0
    over: bool = False

    @property
    def off_path(self) -> float:
        """The farthest that the encoders had the mallet from its path [m]."""
        return max((math.dist(one.place, one.path) for one in self.mallets if one.path), default=0.0)


class Backend(ABC):
    """A table. Nothing is opened when it is made; `connect` opens, and every way out ends in `close`.

    `observes` and `takes` say what `read` gives and `send` takes, with units, before anything is connected.
    `obeys`: whether the mallet goes where plans send it; `patience`: how long putting the puck down may take [s];
    `frame_rate`: of its camera [Hz]; `command_delay`: by which its motors obey late [s], as its board allows for.

    >>> with make_backend("twin", ...) as table:
    ...     table.connect(home)
    ...     table.send(plan)
    ...     table.wait(table.now() + 0.1)
    ...     reading = table.read()
    """

    observes: ClassVar[dict[str, str]] = {
        "frames.time": "s", "frames.puck": "m, (x, y) or None", "frames.opponent": "m, (x, y) or None",
        "frames.robot": "m, (x, y) or None", "frames.puck_covariance": "m^2, (2, 2) or None",
        "frames.opponent_covariance": "m^2, (2, 2) or None", "frames.pucks": "number",
        "frames.troubles": "names and words",
        "mallets.time": "s", "mallets.place": "m, (x, y)", "mallets.path": "m, (x, y) or None",
        "mallets.duties": "of motors left and right, -1 to 1", "mallets.tick": "us, u32, of the board's clock",
    }  # fmt: skip
    takes: ClassVar[dict[str, str]] = {
        "begin": "s", "volts": "V, of axes x and y, signed", "t1": "s, of x and y", "t2": "s, of x and y",
        "modes": "m, (3, 2): rest, slow, fast of x and y",
        "tick": "us, u32, of the begin on the board's clock; set where the plan is sent",
    }  # fmt: skip
    obeys: bool = True
    patience: float = 1.0
    frame_rate: float
    command_delay: float = 0.0

    @property
    def ahead(self) -> float:
        """Time from sending a plan until it acts [s]."""
        return AHEAD + self.command_delay

    @abstractmethod
    def seed(self, seed: int) -> None:
        """Begin the randomness of all that is drawn anew; before `connect`."""

    @abstractmethod
    def connect(self, home: Place) -> None:
        """Connect, home the mallet at `home` [m] and arm. TableFaultError, in one line, if that fails."""

    @abstractmethod
    def clear(self, home: Place) -> None:
        """Play on after a stop: clear the board's fault, home the mallet again if its place was lost, arm.
        TableFaultError, in one line, if what stopped the table is still there."""

    @abstractmethod
    def now(self) -> float:
        """The host's time [s]."""

    @abstractmethod
    def wait(self, until: float) -> None:
        """Serve camera and line until the host's time `until` [s]. TableFaultError, in one line and with the mallet
        stopped, on any doubt about camera or board."""

    @abstractmethod
    def wait_for_frame(self, until: float) -> None:
        """Serve camera and line until the next frame comes, but no longer than `until` [s]; errors as of `wait`."""

    @abstractmethod
    def place(self) -> Place:
        """Where the robot's mallet is by its encoders [m]. TableFaultError where that is not known."""

    def mallet_motion(self, time: float) -> Motion | None:
        """The robot's mallet at `time` [s] where it does not obey; None where it goes as planned."""
        return None

    @abstractmethod
    def read(self) -> Reading:
        """What came since the last call."""

    @abstractmethod
    def send(self, plan: MalletPlan) -> MalletPlan:
        """Send a plan, which acts at its `begin`, and return it as it was sent: earlier by the delay of the motors, and
        rounded to the protocol's numbers. TableFaultError, with the mallet stopped, if it cannot be sent."""

    @abstractmethod
    def stop(self) -> None:
        """Stop the mallet and switch the motors off; whatever the state, without an error."""

    @abstractmethod
    def place_puck(self, puck: np.ndarray) -> None:
        """Have the puck put at (x, y, vx, vy) [m, m/s] by whoever stands at the table."""

    @abstractmethod
    def show(self, game: np.void) -> None:
        """Show the state of the game, a `state.TABLE` record, to the opponent, who plays on by it."""

    @abstractmethod
    def close(self) -> None:
        """Stop, and free all that was opened; may be called again."""

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()
