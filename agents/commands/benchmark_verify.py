"""Does an entry of the leaderboard hold?

The files beside it have to be those that were entered, its protocol the one that is played here, and what it claims
has to come out again: its policy plays new games, of a seed of your own, in a process that may take only so much time
and memory. A policy is data, and no code of it is run. An honest entry is refused once in a thousand times.
"""

from __future__ import annotations

import argparse
import json
import secrets
from dataclasses import asdict
from pathlib import Path

MOST_GAMES = 100_000
OWN_SEEDS = 1 << 24  # so many seeds, above all that the protocol uses


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("entry", type=Path, metavar="ENTRY", help="leaderboard/NAME.toml, or NAME")
    parser.add_argument("--games", type=int, metavar="N", help="of each claim, no fewer than the protocol's (200)")
    parser.add_argument("--seed", type=int, metavar="SEED", help="of these games (drawn anew, and printed)")
    parser.add_argument("--seconds", type=float, default=1200.0, metavar="S", help="that a task may take (1200)")
    parser.add_argument("--memory", type=float, default=4.0, metavar="GB", help="that a process may take (4)")
    parser.add_argument("--json", action="store_true", help="print one JSON object")


def run(args: argparse.Namespace) -> int:
    """0: it holds; 1: it does not. ValueError, in one line, for a file that is no entry."""
    from agents.benchmark.entry import read_entry
    from agents.benchmark.protocol import read_protocol
    from agents.benchmark.sandbox import Limits
    from agents.benchmark.verify import Finding, entry_file, verify
    from puckpilot_env.options.inputs import seed_number

    protocol = read_protocol()
    games = protocol.games if args.games is None else args.games
    if not protocol.games <= games <= MOST_GAMES or games % 2:
        raise ValueError(f"--games is {games}; expected an even number from {protocol.games} to {MOST_GAMES}")
    for name, most in (("seconds", 1e6), ("memory", 1e3)):
        if not 0 < getattr(args, name) <= most:
            raise ValueError(f"--{name} is {getattr(args, name):g}; expected more than 0, up to {most:g}")
    if args.seed is not None:
        seed_number(args.seed)
    entry = read_entry(entry_file(args.entry))
    seed = protocol.evaluation_seed + 1 + secrets.randbelow(OWN_SEEDS) if args.seed is None else args.seed

    def report(finding: Finding) -> None:
        if not args.json:
            print(f"{'holds' if finding.holds else 'FAILS'}  {finding.what}: {finding.words}", flush=True)

    findings = verify(entry, protocol, games, seed, Limits(args.seconds, int(args.memory * (1 << 30))), report)
    holds = all(one.holds for one in findings)
    if args.json:
        print(json.dumps({"entry": entry.name, "holds": holds, "seed": seed, "findings": [asdict(f) for f in findings]},
                         indent=1))  # fmt: skip
    else:
        print(f"{entry.name} {'holds' if holds else 'does not hold'} (seed {seed})")
    return 0 if holds else 1
