"""The host's end of the serial line, which holds however many bytes are sent or come."""

from __future__ import annotations

import numpy as np

from sim2real.emulate.board.access import flush_at, send_at


class SerialLine:
    """boards: an array of one `board_state.BOARD`, which has room for more than a second of bytes either way."""

    def __init__(self, boards: np.ndarray) -> None:
        self._address, dma = boards.ctypes.data, boards["dma"]
        self._count, self._sent = dma["count"], dma["sent"][0]
        self._to_send, self._received = b"", b""
        send_at(self._address, np.frombuffer(b"", np.uint8))  # compiled before a board of real time is waited for
        self.flush()

    def send(self, data: bytes) -> None:
        """Send bytes, now or after those that are still being sent."""
        self._to_send += data
        self._fill()

    def _fill(self) -> None:
        if self._to_send:
            self._to_send = self._to_send[send_at(self._address, np.frombuffer(self._to_send, np.uint8)) :]

    def carry_on(self) -> None:
        """Give the line what it has room for, and take what was sent: once a second, or more often."""
        self._fill()
        if count := self._count.item(0):
            self._received += self._sent[:count].tobytes()
            self._count[0] = 0

    def flush(self) -> None:
        """Let the bytes count as sent that are over by now."""
        flush_at(self._address)

    def received(self) -> bytes:
        """The bytes that the board sent since the last call."""
        self.flush()
        self.carry_on()
        data, self._received = self._received, b""
        return data
