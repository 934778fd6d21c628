"""Messages as bytes on the line: `messages.py` (generated) defines them, `bodies.py` packs their fields with checks of
the limits, `frames.py` adds id and CRC and reads a byte stream, `cobs.py` encodes frames without zeros."""
