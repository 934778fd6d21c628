"""The microcontroller in an emulator: the very ELF that is flashed, on a Cortex-M3 with the peripherals it uses."""
