"""The microcontroller's program: build it, see what it is, or run it without a board.

- info: the protocol, the flashed program's size and checksum, and how many instructions its ticks take.
- build: write both sides' messages from firmware/protocol.toml, and compile; needs make and arm-none-eabi-gcc.
- emulate: run the program in an emulator, with a gantry on its motors, behind a serial port of its own, until Ctrl-C:
  `puckpilot link monitor PORT` and all that talks to a board talk to it there, at whatever speed. No hand can move its
  mallet, as `calibrate gantry` asks for.
"""

from __future__ import annotations

import argparse
import json
import shutil
import subprocess
import time
from pathlib import Path
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("action", choices=("info", "build", "emulate"), help="what to do")
    parser.add_argument("--port", type=Path, metavar="PATH", help="of emulate: a link to make to its serial port")
    parser.add_argument("--seconds", type=float, metavar="S", help="of emulate: end after so long")
    parser.add_argument(
        "--place", type=float, nargs=2, default=(0.1, 0.2), metavar=("X", "Y"),
        help="of emulate: where the mallet stands at first [m] (0.1 0.2)",
    )  # fmt: skip
    parser.add_argument("--json", action="store_true", help="of info: print one JSON object")


def run(args: argparse.Namespace) -> int:
    """0: did it. Raises ValueError, in one line, for what cannot be."""
    return {"info": _info, "build": _build, "emulate": _emulate}[args.action](args)


def _info(args: argparse.Namespace) -> int:
    import zlib

    from firmware import ELF
    from firmware.definition import read_protocol
    from sim2real.emulate.elf import read_elf

    protocol, program = read_protocol(), read_elf(ELF)
    found: dict[str, Any] = {
        "program": ELF.name, "crc32": f"{zlib.crc32(ELF.read_bytes()):08x}",
        "flash_bytes": sum(len(segment.data) for segment in program.segments),
        "protocol": ".".join(map(str, protocol.version)), "schema": f"{protocol.schema:08x}",
        "messages": {one.name: {"id": one.id, "from": one.sender, "bytes": one.size} for one in protocol.messages},
        "ticks": _ticks(),
    }  # fmt: skip
    if args.json:
        print(json.dumps(found, indent=1))
        return 0
    print(f"{ELF}: {found['flash_bytes']} bytes of flash, CRC-32 {found['crc32']}")
    print(f"protocol {found['protocol']}, schema {found['schema']}\n")
    print(f"{'message':10}  {'id':>2}  {'bytes':>5}  from")
    for name, row in found["messages"].items():
        print(f"{name:10}  {row['id']:2}  {row['bytes']:5}  {row['from']}")
    if found["ticks"]:
        print("\nmost instructions of a tick, of 72,000 cycles in a millisecond, counted in the emulator:")
        for what, count in found["ticks"].items():
            print(f"  {what:42} {count:6,}")
    else:
        print("\nticks are counted in the emulator, which needs unicorn: pip install 'puckpilot[emulate]'")
    return 0


def _ticks() -> dict[str, int]:
    try:
        from sim2real.emulate.ticks import count_ticks
    except ImportError:
        return {}
    return count_ticks()


def _build(args: argparse.Namespace) -> int:
    from firmware import ELF, FOLDER
    from firmware.definition import read_protocol
    from firmware.generate import write

    missing = [name for name in ("make", "arm-none-eabi-gcc") if not shutil.which(name)]
    if missing:
        raise ValueError(f"building needs {' and '.join(missing)}; install Debian's make and gcc-arm-none-eabi")
    for path in write(read_protocol()):
        print(f"wrote {path}")
    done = subprocess.run(["make", "-s", "-C", str(FOLDER), "f103"], capture_output=True, text=True)
    if done.returncode:
        raise ValueError(f"the program does not build: {(done.stderr or done.stdout).strip().splitlines()[0]}")
    print(f"wrote {ELF}\n{done.stdout.strip()}")
    return 0


def _emulate(args: argparse.Namespace) -> int:
    from firmware import ELF

    if args.seconds is not None and not args.seconds > 0:
        raise ValueError(f"--seconds is {args.seconds:g}; expected more than 0")
    from puckpilot_env.parameters import BY_NAME

    sizes = [BY_NAME[name].default for name in ("length", "width")]
    if not all(0.0 <= at <= size for at, size in zip(args.place, sizes, strict=True)):
        raise ValueError(f"--place is {args.place[0]:g} {args.place[1]:g}; expected a place on the table, 0 0 to "
                         f"{sizes[0]:g} {sizes[1]:g} m")  # fmt: skip
    try:
        from sim2real.emulate.gantry import Gantry
        from sim2real.emulate.machine import Machine
    except ImportError:
        raise ValueError("the emulator needs unicorn; install it with: pip install 'puckpilot[emulate]'") from None
    from sim2real.emulate.paced import serve, terminal

    machine = Machine(ELF, seed=time.time_ns() % 2**31)
    gantry = Gantry(machine, place=(args.place[0], args.place[1]))
    most = float("inf") if args.seconds is None else args.seconds
    with terminal(args.port) as (descriptor, name):
        print(f"the board is at {name}; Ctrl-C ends it", flush=True)
        try:
            behind = serve(machine, descriptor, lambda seconds: seconds < most)
        except KeyboardInterrupt as stop:
            if stop.args:  # told to end from outside
                raise
            behind = 0.0
    x, y = gantry.place(machine.now)
    print(f"{machine.now * 1e-6:.1f} s of the board's time; the mallet is at ({x:.3f}, {y:.3f}) m")
    if behind > 0.0:
        print(f"this machine was too slow by {behind:.1f} s: the board lived so much less")
    return 0
