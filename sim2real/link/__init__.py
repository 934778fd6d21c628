"""The host's end of the line to the microcontroller: frames, messages, a serial port, one clock for both."""
