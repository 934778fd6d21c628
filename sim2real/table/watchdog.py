"""The watchdog over the camera: late, missing or bad pictures, and pucks that are none or too many, stop the table."""

from __future__ import annotations

from collections.abc import Sequence

from sim2real.table.backend import SeenFrame
from sim2real.table.faults import Cause, TableFaultError

BLIND = 2.5  # periods without a new frame after which the camera counts as lost: two frames are missing then
LATE = 0.05  # s of a frame's age when it comes; predictions from older ones are no ground to move on
LATE_FRAMES = 3  # so many late frames in a row: one alone is a hiccup
CROWDED = 12  # frames in a row with more than one candidate for the puck: a tenth of a second


class CameraWatchdog:
    """Judges every frame, and their absence. begin: host's time from which frames are expected [s]; rate: of these
    [Hz]."""

    def __init__(self, begin: float, rate: float) -> None:
        self._newest_came, self._blind = begin, BLIND / rate
        self._late = self._crowded = 0

    def check(self, now: float, frames: Sequence[SeenFrame]) -> None:
        """Take the frames that came at `now` [s]. TableFaultError, in one line, if play cannot go on."""
        for frame in frames:
            self._newest_came = now
            self._check_frame(now, frame)
        silent = now - self._newest_came
        if silent > self._blind:
            raise TableFaultError(
                Cause.CAMERA_SILENT, f"no frame for {1e3 * silent:.0f} ms; check the camera and clear"
            )

    def _check_frame(self, now: float, frame: SeenFrame) -> None:
        refuse_troubles(frame)
        age = now - frame.time
        self._late = self._late + 1 if age > LATE else 0
        if self._late >= LATE_FRAMES:
            raise TableFaultError(
                Cause.CAMERA_LATE,
                f"frames come {1e3 * age:.0f} ms late; at most {1e3 * LATE:.0f} are expected: check what loads this "
                "computer, then clear",
            )
        self._crowded = self._crowded + 1 if frame.pucks > 1 else 0
        if self._crowded >= CROWDED:
            raise TableFaultError(
                Cause.SEVERAL_PUCKS, f"{frame.pucks} pucks are seen; leave one on the table, then clear"
            )


def refuse_troubles(frame: SeenFrame) -> None:
    """TableFaultError for a frame with something wrong."""
    if frame.troubles:
        trouble = frame.troubles[0]
        cause = Cause.SEVERAL_PUCKS if trouble.name == Cause.SEVERAL_PUCKS else Cause.CAMERA_TROUBLE
        raise TableFaultError(cause, f"{trouble.name}: {trouble.text}; then clear")
