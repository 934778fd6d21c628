"""An emulator of the microcontroller: it runs the ELF file that is flashed, on a Cortex-M3 with the peripherals it
uses.

The path of an instruction: `machine.py` is the whole board in virtual time; `elf.py` loads the program, `cortex_m.py`
runs it in Unicorn, which calls `board/callbacks.py` for each access to a register (`board/bus.py` finds it and
`peripherals/` answer) and each exception (`board/core.py`). Between the program's runs `board/execution.py` lets time
pass, from one event of `timeline.py` to the next. All of that is compiled and works on one record,
`board/board_state.py`; Python is called for the angle of a shaft and at a change of the motors' duties.
`board/block_timing.py` charges time to every block of code when exact timing is wanted. `gantry.py` connects motors to
encoders, `pseudo_terminal.py` makes the board reachable as a serial port, `tick_instructions.py` counts the
instructions of a control tick.
"""
