"""Run the microcontroller's program in an emulator, with a gantry on its motors, at a serial port of its own.

It serves `puckpilot link monitor PORT` and other programs for a board, at any baud rate, until Ctrl-C. Its mallet
cannot be moved by hand, so `calibrate gantry` does not work with it.
"""

from __future__ import annotations

import argparse
import time
from pathlib import Path


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("--port", type=Path, metavar="PATH", help="a link to make to its serial port")
    parser.add_argument("--seconds", type=float, metavar="S", help="end after S seconds (until Ctrl-C)")
    parser.add_argument(
        "--place", type=float, nargs=2, default=(0.1, 0.2), metavar=("X", "Y"),
        help="initial place of the mallet [m] (0.1 0.2)",
    )  # fmt: skip


def run(args: argparse.Namespace) -> int:
    """Run the emulator until the time is over or Ctrl-C. Returns 0; raises ValueError, in one line, if that is
    impossible."""
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
    from sim2real.emulate.pseudo_terminal import serve, terminal

    machine = Machine(ELF, seed=time.time_ns() % 2**31)
    gantry = Gantry(machine, place=(args.place[0], args.place[1]))
    most = float("inf") if args.seconds is None else args.seconds
    with terminal(args.port) as (descriptor, name):
        print(f"the board is at {name}; Ctrl-C ends it", flush=True)
        try:
            behind = serve(machine, descriptor, lambda seconds: seconds < most)
        except KeyboardInterrupt as stop:
            if stop.args:  # terminated from outside
                raise
            behind = 0.0
    x, y = gantry.place(machine.now)
    print(f"{machine.now * 1e-6:.1f} s of the board's time; the mallet is at ({x:.3f}, {y:.3f}) m")
    if behind > 0.0:
        print(f"this machine was too slow: the board's clock is {behind:.1f} s behind")
    return 0
