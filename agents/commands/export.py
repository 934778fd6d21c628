"""Write a policy in another form: .npz, played without torch by this package, or .onnx for other programs.

The ONNX model takes observations (n, d) as the variant gives them, in the order of its `columns`, and returns actions
(n, 4): target x, y [m] and voltages x, y [V].
"""

from __future__ import annotations

import argparse
from pathlib import Path

ENDINGS = (".npz", ".onnx")


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of the command."""
    parser.add_argument("policy", metavar="POLICY", help="a policy by name, .npz file or run's folder")
    parser.add_argument("--out", type=Path, required=True, metavar="FILE", help="what to write: .npz or .onnx")


def run(args: argparse.Namespace) -> int:
    """0: written. Raises ValueError, in one line, for what cannot be read or written."""
    from agents.policy.policy import find_policy

    if args.out.suffix not in ENDINGS:
        raise ValueError(f"--out is {args.out}; expected a file that ends in {' or '.join(ENDINGS)}")
    policy = find_policy(args.policy)
    if args.out.suffix == ".npz":
        policy.save(args.out)
    else:
        from agents.policy.onnx_file import write_onnx

        write_onnx(policy, args.out)
    sizes = " x ".join(str(size) for size in policy.network.sizes)
    about = ", ".join(f"{name} {value}" for name, value in policy.about.items())
    print(f"wrote {args.out}: {sizes} numbers, {args.out.stat().st_size / 1000:.0f} kB; {about}")
    return 0
