"""A table on a laptop, in virtual time: the flashed firmware in the emulator, an independent plant, measured places.

- `plant`: puck and mallets in small steps, which shares no code with the simulator.
- `board`: the emulated microcontroller on the plant's motors and encoders, and its serial line.
- `camera`: places of puck and opponent with a camera's rate, delay and noise.
- `hand`: a scripted player with the opponent's mallet.
- `twin`: all of it as a backend.
"""
