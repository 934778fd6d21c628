"""Describe the microcontroller's program: its protocol, size and checksum, and the instructions of its ticks."""

from __future__ import annotations

import argparse
import json
from typing import Any


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """Print the description. Returns 0."""
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
    """The instructions of ticks; empty if the emulator is not installed."""
    try:
        from sim2real.emulate.tick_instructions import count_ticks
    except ImportError:
        return {}
    return count_ticks()
