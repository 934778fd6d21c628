"""The host's end of the line to the microcontroller: frames, messages, a serial port, one clock for both."""

BAUD = 1_000_000  # of the board's line
