"""Calibrate the physical table, guided step by step.

- gantry PORT: the pulley's radius, with the mallet moved by hand from corner to corner.
- camera IMAGES: a camera's intrinsics from photographs of a checkerboard or a ChArUco board.
- table VIEWS: the places of the markers round a table and its surface, from photographs and measured points.

puckpilot calibrate WHAT --help explains one.
"""

from __future__ import annotations

import argparse

from sim2real.commands import calibrate_camera, calibrate_gantry, calibrate_table

KINDS = {"gantry": calibrate_gantry, "camera": calibrate_camera, "table": calibrate_table}


def add_arguments(parser: argparse.ArgumentParser) -> None:
    """Declare the arguments of each kind of calibration."""
    kinds = parser.add_subparsers(dest="what", required=True, metavar="WHAT", help="what to calibrate")
    for name, module in KINDS.items():
        kind = kinds.add_parser(name, description=module.__doc__, formatter_class=parser.formatter_class)
        module.add_arguments(kind)


def run(args: argparse.Namespace) -> int:
    """0: calibrated. Raises ValueError, in one line, for what cannot be."""
    return KINDS[args.what].run(args)
