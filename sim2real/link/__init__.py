"""The host's end of the serial line to the microcontroller.

The path of a message: `session.py` greets the board, pings it, sends orders and collects what it reports; `wire/` turns
messages into frames and back; `connection.py` reopens a lost port, `serial_port.py` is the port. `pings.py` exchanges
time stamps, from which `board_clock.py` estimates the board's clock with the lines of `envelope_lines.py`;
`estop_repeater.py` repeats an emergency stop until it is confirmed; `telemetry_status.py` counts missing telemetry.
For the commands: `arguments.py` opens a session, `link_quality.py` measures a line, `status_text.py` describes events
and status, `two_points.py` calibrates the gantry's pulley.
"""

BAUD = 1_000_000  # of the board's line
