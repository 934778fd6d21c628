"""Why a table stopped: the causes, and the error that names one."""

from __future__ import annotations

from enum import StrEnum


class Cause(StrEnum):
    """What stopped a table, or kept it from being used; the value is the word that logs and infos have."""

    NOT_READY = "not ready"  # it was not connected, or a step of the bring-up failed
    PORT_LOST = "port lost"
    BOARD_SILENT = "board silent"
    BOARD_STOPPED = "board stopped"  # the board switched the motors off by itself
    BOARD_NOT_ARMED = "board not armed"  # it was reset, or disarmed by somebody else
    PLAN_REFUSED = "plan refused"
    OVERRUN = "overrun"  # the player, or the computer, took so long that the board was not served
    CAMERA_SILENT = "camera silent"
    CAMERA_LATE = "camera late"
    CAMERA_TROUBLE = "camera trouble"  # moved, wrong light, damaged pictures
    PUCK_LOST = "puck lost"
    SEVERAL_PUCKS = "several pucks"


class TableFaultError(ValueError):
    """The table stopped, or cannot be used. The text is one line that says why and what to do."""

    def __init__(self, cause: Cause, text: str) -> None:
        super().__init__(text)
        self.cause = cause
