"""The camera's clock on the host, estimated from the frames' stamps and their arrivals.

A frame never arrives before it is exposed, read out and sent. So the line that maps the camera's time to the host's
passes below all arrivals less this least delay, and every now and then a frame is hardly later than that: in each
block of frames the earliest is at most a certain excess late, as small a one as a line allows. A late frame gives a
weaker constraint, never a wrong one, so heavy tails of the delays need no filter.

Where no line fits any more, all frames come later by a step, or the camera's clock has jumped, which look alike.
Frames that are late and are taken for fresh ones are dangerous; so a step of less than a second is lateness.
"""

from __future__ import annotations

import math
from collections import deque

import numpy as np

from sim2real.link.envelope_lines import EnvelopeLines

BLOCK = 0.25  # s of frames of which the earliest is kept
WINDOW = 20.0  # s of blocks that are used: a crystal's rate changes by little more than 0.1 ppm in it
MOST_DRIFT = 300e-6  # bound of the camera's clock rate minus 1; a bad crystal has 100e-6
SHORT = 0.1  # s, span of frames below which the rate is taken as 1, because they hardly determine it
LATENESS = 1.0  # s by which all frames may come later than before; a clock that was set anew is off by more
LEAST_EXCESS, MOST_EXCESS = 50e-6, 3.2e-3  # s, of the earliest frames of blocks; beyond it the clock has jumped


class CameraClock:
    """The mapping between a camera's clock and the host's (time.perf_counter), both in seconds.

    least_delay: known least time from the middle of the exposure to the arrival [s]: half of the exposure, readout and
    transport. Where it is unknown, give 0: all times are later then by what it really is.
    """

    def __init__(self, least_delay: float = 0.0) -> None:
        self._least_delay = least_delay
        self.jumps = 0  # number of times that no line fitted the frames and older ones were dropped
        self.late = 0.0  # s by which all frames come later than the first ones did
        self._earliest: deque[tuple[float, float]] = deque()  # of each block: camera's time, and the host's less that
        self._begun = -math.inf  # camera's time at which the present block began
        self._origin, self._offset, self._slope = 0.0, 0.0, 0.0
        self._excess = LEAST_EXCESS

    def __len__(self) -> int:
        """The number of blocks in use."""
        return len(self._earliest)

    def add(self, camera_s: float, host_s: float) -> None:
        """Add a frame by the camera's time of its exposure's middle and the host's time of its arrival [s], in order
        of time. A clock that runs back, or a line that fits no more, is a jump: older frames are dropped."""
        if self._earliest and camera_s < self._earliest[-1][0] - BLOCK:
            self.jumps += 1
            self.late = 0.0
            self._earliest.clear()
        if self.late > 0.0:
            self._end_lateness(camera_s, host_s)
        point = camera_s, host_s - camera_s - self._least_delay - self.late
        if not self._earliest or camera_s - self._begun >= BLOCK:
            self._begun = camera_s
            self._earliest.append(point)
        elif self._late(point) < self._late(self._earliest[-1]):
            self._earliest[-1] = point
        else:
            return
        while self._earliest[0][0] < camera_s - WINDOW:
            self._earliest.popleft()
        self._fit()

    def to_host(self, camera_s: float) -> float:
        """The host's time [s] at a time of the camera's clock [s]. Raises ValueError before the first frame."""
        self._check_known()
        return camera_s + self._offset + self._slope * (camera_s - self._origin)

    def to_camera(self, host_s: float) -> float:
        """The camera's time [s] at a time of the host's clock [s]. Raises ValueError before the first frame."""
        self._check_known()
        return self._origin + (host_s - self._offset - self._origin) / (1.0 + self._slope)

    @property
    def drift(self) -> float:
        """The relative rate error of the camera's clock: 50e-6 gains 50 us in a second."""
        return 1.0 / (1.0 + self._slope) - 1.0

    @property
    def drift_error(self) -> float:
        """The bound of the error of `drift` under the conditions of `error_s`; inf without frames."""
        if not self._earliest:
            return math.inf
        flattest, steepest = self._lines(2.0 * self._excess).slope_bounds()
        return max(self._slope - flattest, steepest - self._slope)

    @property
    def error_s(self) -> float:
        """The bound of the error of `to_host` at the newest frame [s], given the least delay; inf without frames.

        It holds if the camera's clock keeps a constant rate through WINDOW, and if the earliest frame of each block is
        late by no more than twice the excess that was found, beyond what all of them share.
        """
        if not self._earliest:
            return math.inf
        x = self._earliest[-1][0] - self._origin
        low, high = self._lines(2.0 * self._excess).bounds_at(x)
        own = self._offset + self._slope * x
        return max(high - own, own - low)

    def _late(self, point: tuple[float, float]) -> float:
        return point[1] - self._slope * (point[0] - self._origin)

    def _end_lateness(self, camera_s: float, host_s: float) -> None:
        """A frame that comes sooner than late ones can: all come later by less now, or no more."""
        left = host_s - self.to_host(camera_s) - self._least_delay
        if left < self.late - MOST_EXCESS:
            self.late = left if left > MOST_EXCESS else 0.0

    def _check_known(self) -> None:
        if not self._earliest:
            raise ValueError("the camera's clock is unknown: no frame has come yet; add one")

    def _fit(self) -> None:
        """The central line of the least excess that allows one; after a jump, of the newer frames alone."""
        newest, jumps = self._earliest[-1][0], self.jumps
        expected = self._offset + self._slope * (newest - self._origin)
        self._fit_newest()
        if self.jumps > jumps:
            step = self._lateness(self._offset - expected)
            self.late += step
            self._offset -= step
            self._earliest = deque((camera, host - step) for camera, host in self._earliest)

    def _lateness(self, step: float) -> float:
        """The part of a step of the offset [s] that is lateness."""
        return step if 0.0 < step < LATENESS else 0.0

    def _fit_newest(self) -> None:
        self._origin = self._earliest[-1][0]
        while True:
            self._excess = LEAST_EXCESS
            while self._excess <= MOST_EXCESS:
                if (line := self._lines(self._excess).central_line(SHORT)) is not None:
                    self._offset, self._slope = line
                    return
                self._excess *= 2.0
            self.jumps += 1
            for _ in range((len(self._earliest) + 1) // 2):
                self._earliest.popleft()

    def _lines(self, excess: float) -> EnvelopeLines:
        """The lines from which the earliest frame of each block is late by an excess [s] at most. x: the camera's time
        since the newest block's [s]; y: the host's less it [s]."""
        upper = np.array(self._earliest) - (self._origin, 0.0)
        whole = upper[: max(len(upper) - 1, 1)]  # the present block may have had late frames alone so far
        return EnvelopeLines(whole - (0.0, excess), upper, MOST_DRIFT)
