"""An emulator of the microcontroller: it runs the ELF file that is flashed, on a Cortex-M3 with the peripherals it
uses.

The path of an instruction: `machine.py` is the whole board in virtual time; `elf.py` loads the program, `cortex_m.py`
runs it in Unicorn with `core_registers.py`, `timeline.py` schedules events and `peripherals/` answers register
accesses; `block_timing.py` charges time to every block of code when exact timing is wanted. `gantry.py` connects motors
to encoders, `pseudo_terminal.py` makes the board reachable as a serial port, `tick_instructions.py` counts the
instructions of a control tick.
"""
