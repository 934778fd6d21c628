"""The microcontroller's program, and where its files are."""

from pathlib import Path

FOLDER = Path(__file__).parent
PROTOCOL = FOLDER / "protocol.toml"
ELF = FOLDER / "puckpilot-f103.elf"  # what is flashed
QEMU_ELF = FOLDER / "puckpilot-qemu.elf"  # the same core for a machine of QEMU's
PWM_FULL = 3600  # duty of full voltage in telemetry, as in core/include/robot.h
