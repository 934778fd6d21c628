"""The physical table of a table.toml as a backend: its camera, its board, and a person at the terminal."""

from __future__ import annotations

from dataclasses import replace
from os import PathLike

from sim2real.camera.grey_image import read_grey
from sim2real.camera.live.setup_picture import take_setup_picture
from sim2real.camera.sources import RATE, open_source
from sim2real.link.serial_port import SerialPort
from sim2real.table.backend import Place
from sim2real.table.board_config import board_config
from sim2real.table.faults import Cause, TableFaultError
from sim2real.table.game.game_record import GameRecord
from sim2real.table.physical.eyes import LiveEyes
from sim2real.table.physical.frame_reader import FrameReader
from sim2real.table.physical.homing import exact_place
from sim2real.table.physical.person import PersonAtTerminal
from sim2real.table.physical.real_time import RealTimeTable
from sim2real.table.physical.table_file import CameraPart, read_table_file
from sim2real.vision.calibrate.table_file import read_table
from sim2real.vision.track.blobs import LEVEL
from sim2real.vision.track.ring import HEIGHTS
from sim2real.vision.track.tracker import Targets

SIZE_ERROR = 0.01  # m by which a calibration and the stated table may differ


class PhysicalTable(RealTimeTable):
    """See `Backend`. table: a table.toml (`table_file.py`). ValueError, in one line, for a file that cannot be used, or
    one whose parameters are not the game's. command_delay: of the motors [s], in place of the file's."""

    def __init__(self, game: GameRecord, table: str | PathLike[str], command_delay: float | None = None) -> None:
        self._file = read_table_file(table)
        _refuse_other_parameters(self._file.parameters, game)
        camera, board = self._file.camera, self._file.board
        _refuse_other_table(camera, game)
        frame_reader(camera)  # refuses what cannot be used, before anything is opened
        super().__init__(
            board_config(game.p, board.gains, board.command_delay if command_delay is None else command_delay),
            camera.settings.rate or RATE,
            lambda: SerialPort(board.port, board.baud, wait=0.0),
            lambda: live_eyes(camera),
            PersonAtTerminal,
        )
        self._pulley_radius = float(game.p["pulley_radius"])

    def _at_home(self, home: Place) -> Place:
        """The mallet's exact place by its encoders [m], that was put near `home` [m]."""
        offsets, telemetry = self._file.board.offsets, self._opened(self.line).session.telemetry
        if offsets is None or telemetry is None:
            return home
        try:
            return exact_place(telemetry.angle, offsets, self._pulley_radius, home)
        except ValueError as error:
            raise TableFaultError(Cause.NOT_READY, str(error)) from None


def live_eyes(camera: CameraPart) -> LiveEyes:
    """The camera's eyes, not yet opened; its setup picture is taken now, if it is to be taken. TableFaultError, in one
    line, where that fails."""
    reader, settings = frame_reader(camera), replace(camera.settings, setup_exposure=None)
    try:
        if camera.settings.setup_exposure is not None:
            reader.tracker.set_up(take_setup_picture(camera.source, camera.settings, reader.tracker.sensor))
        return LiveEyes(open_source(camera.source, settings), reader, camera.delay)
    except ValueError as error:
        raise TableFaultError(Cause.NOT_READY, str(error)) from None


def frame_reader(camera: CameraPart) -> FrameReader:
    """What reads a camera's frames. ValueError, in one line, for a calibration or setup picture that cannot be used."""
    calibration = read_table(camera.calibration)
    height = HEIGHTS["standard"] if camera.ring_height is None else camera.ring_height
    targets = Targets(camera.film_radius, height, LEVEL if camera.level is None else camera.level)
    reader = FrameReader(calibration, targets, camera.settings)
    if camera.setup is not None:
        reader.tracker.set_up(read_grey(camera.setup))
    return reader


def _refuse_other_table(camera: CameraPart, game: GameRecord) -> None:
    setup = read_table(camera.calibration).setup
    for name, measured in (("length", setup.length), ("width", setup.width)):
        if abs(measured - float(game.p[name])) > SIZE_ERROR:
            raise ValueError(
                f"{camera.calibration} is of a table of {name} {measured:g} m, the game's is {float(game.p[name]):g} m"
                f"; state {name} under [parameters] of the table's file, or calibrate this table"
            )


def _refuse_other_parameters(parameters: dict[str, float], game: GameRecord) -> None:
    for name, value in parameters.items():
        if abs(value - float(game.p[name])) > 1e-9 * abs(value):
            raise ValueError(
                f"the table's file has {name} {value:g}, the game {float(game.p[name]):g}; "
                "give parameters=read_table_file(FILE).parameters, of sim2real.table.physical.table_file"
            )
