"""The physical table as a backend: a camera, the board at its port, and a person, in real time."""

from __future__ import annotations

import time
from os import PathLike

from sim2real.camera.sources import RATE, open_source
from sim2real.link.serial_port import PortError, SerialPort
from sim2real.table.backend import Place
from sim2real.table.board_config import board_config
from sim2real.table.board_line import POLL, BoardLine
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game_record import GameRecord
from sim2real.table.live_table import LiveTable
from sim2real.table.physical.eyes import LiveEyes
from sim2real.table.physical.homing import exact_place
from sim2real.table.physical.person import PersonAtTerminal
from sim2real.table.physical.reader import frame_reader
from sim2real.table.physical.table_file import read_table_file

DOZE = 0.0003  # s of sleep between looks at camera and line, which wait themselves for a millisecond


class PhysicalTable(LiveTable):
    """See `Backend`. table: a table.toml (`table_file.py`). ValueError, in one line, for a file that cannot be used, or
    one whose parameters are not the game's."""

    patience = float("inf")

    def __init__(self, game: GameRecord, table: str | PathLike[str]) -> None:
        self._file = read_table_file(table)
        _refuse_other_parameters(self._file.parameters, game)
        rate = self._file.camera.settings.rate or RATE
        super().__init__(board_config(game.p, self._file.board.gains), rate)
        self._reader = frame_reader(self._file)
        self._pulley_radius = float(game.p["pulley_radius"])
        self.live: LiveEyes | None = None

    def seed(self, seed: int) -> None:
        """Nothing of a physical table is drawn."""

    def open(self, home: Place) -> None:
        board, camera = self._file.board, self._file.camera
        try:
            self.line = BoardLine(lambda: SerialPort(board.port, board.baud), self.now, self.pass_time)
        except PortError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None
        self.eyes = self.live = LiveEyes(open_source(camera.source, camera.settings), self._reader, camera.delay)
        self.live.open()
        self.person = PersonAtTerminal(self._look)

    def _look(self) -> None:
        """Serve line and camera while a person takes their time."""
        self.pass_time(self.now() + POLL)
        if self.line is not None:
            self.line.poll()

    def _at_home(self, home: Place) -> Place:
        """The mallet's exact place by its encoders, which was put near `home` [m]."""
        offsets, line = self._file.board.offsets, self._opened(self.line)
        if offsets is None or line.session.telemetry is None:
            return home
        try:
            return exact_place(line.session.telemetry.angle, offsets, self._pulley_radius, home)
        except ValueError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None

    def now(self) -> float:
        """The host's clock [s]."""
        return time.perf_counter()

    def pass_time(self, until: float) -> None:
        time.sleep(min(max(until - self.now(), 0.0), DOZE))

    def _shut(self) -> None:
        if self.live is not None:
            self.live.close()
        self.live = None


def _refuse_other_parameters(parameters: dict[str, float] | object, game: GameRecord) -> None:
    for name, value in dict(parameters).items():  # pyright: ignore[reportArgumentType, reportCallIssue]
        if abs(value - float(game.p[name])) > 1e-9 * abs(value):
            raise ValueError(
                f"table.toml has {name} {value:g}, the game {float(game.p[name]):g}; "
                "make the game with the file's parameters, as `puckpilot play` does"
            )
